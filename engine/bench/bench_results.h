// What a bench has found out, ready to be written.
#pragma once

#include <string>
#include <vector>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_plan.h"
#include "engine/bench/bench_scene.h"
#include "engine/bench/cost_fit.h"
#include "engine/bench/machine.h"
#include "engine/bench/sequence_error.h"

namespace engine {

/// Against which the share of patches and frames that miss is counted: the default of mode `default`.
inline constexpr double kBenchTolerance = 0.05;

/// One run with what can be said of it beside its group's.
struct RunResult {
  BenchRun run;
  SequenceError error;  ///< against the group's full run; of that itself 0
  double absolute_speed_up = 0, relative_speed_up = 0;

  double seconds() const { return run.estimation_s + run.computation_s; }
};

struct GroupResult {
  std::string name;
  std::vector<RunResult> runs;  ///< the full one first
  BenchRun alone;
  double alone_s = 0;  ///< all frames one by one, from those that were run
  SceneNumbers numbers;
  CostFit cost;      ///< of the runs that interpolate all light, and the full one
  double lines = 0;  ///< N
};

const RunResult* find_run(const std::vector<GroupResult>& groups, const std::string& name);

/// Runs a group's jobs and compares them. Tells each on standard error as it ends.
api::Result<GroupResult> run_group(const BenchGroup& group, const BenchOptions& options,
                                   const std::filesystem::path& program);

}  // namespace engine
