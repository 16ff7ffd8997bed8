// The solution of a whole sequence as a checkpoint: what images are rendered from.
#pragma once

#include <optional>

#include "api/job_report.h"
#include "engine/base/checkpoint.h"
#include "engine/pipeline/solve_sequence.h"

namespace engine {

/// Saves the solution, and of `report` what solving has added to it. Errors: as Checkpoints::save.
api::Status save_solved(const SolvedSequence& solved, const api::JobReport& report, Checkpoints& checkpoints);

/// The solution that an earlier attempt saved, or nothing. Then `report` gets its warnings, counts and errors
/// as well; the seconds of the stages stay those of this attempt.
std::optional<SolvedSequence> load_solved(const Checkpoints& checkpoints, api::JobReport& report);

}  // namespace engine
