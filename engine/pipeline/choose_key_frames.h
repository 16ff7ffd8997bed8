// Estimate and choice of the key-frames, as stages of a job.
#pragma once

#include <vector>

#include "api/job_report.h"
#include "engine/animation/light_groups.h"
#include "engine/base/checkpoint.h"
#include "engine/keyframes/select_key_frames.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {

/// The frames that mode `options.mode` solves. Adds the lines of the estimate to `report`, and goes on from
/// what an earlier run left in `checkpoints`. Errors: stopped; of the estimate's mesh as Estimator::begin
/// says.
api::Result<KeyFrames> choose_key_frames(const LitScene& lit, const std::vector<LightGroup>& groups,
                                         const api::LightingOptions& options, Checkpoints& checkpoints,
                                         StageClock& clock, api::JobReport& report);

}  // namespace engine
