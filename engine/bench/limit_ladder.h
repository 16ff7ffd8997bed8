// The settings of `bench limit`, run: all of them once, those that matter several times, in turn.
#pragma once

#include <optional>
#include <vector>

#include "engine/bench/limit_choice.h"
#include "engine/bench/limit_plan.h"
#include "engine/bench/limit_reference.h"

namespace engine {

struct RungRun {
  LadderRung rung;
  BenchJob job;
  BenchRun run;
  LimitError error;
  double seconds = 0;  ///< median, of all frames of the sequence
};

struct Ladder {
  std::vector<RungRun> runs;
  std::optional<std::size_t> rough, fine;  ///< the cheapest within ErrorBars::rough, ::fine
};

std::vector<Measured> curve_of(const std::vector<RungRun>& runs);

/// Climbs until both bars are met and what comes next is far too dear; then repeats those that may be the
/// cheapest. Errors: of the jobs.
api::Result<Ladder> climb_ladder(LimitBench& bench, const LimitReference& reference);

/// Some frames one by one, in mode frame-by-frame: the same kernels without anything shared between frames.
struct AloneCurve {
  std::vector<RungRun> runs;      ///< seconds: those of all frames, scaled
  std::vector<FramePair> frames;  ///< of these runs, against the sequence
};
api::Result<AloneCurve> run_alone(LimitBench& bench, const LimitReference& reference);

}  // namespace engine
