// Which jobs `bench paper` runs.
#pragma once

#include <vector>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_paper.h"

namespace engine {

/// A scene whose runs are compared: with `full`, which solves every frame with the same lines, and with
/// `alone`, which solves some frames one by one.
struct BenchGroup {
  std::string name;  ///< "garage"
  BenchJob full;
  BenchJob alone;              ///< mode `frame-by-frame`, a few frames
  std::vector<BenchJob> runs;  ///< with key-frames
};

inline constexpr std::uint32_t kBenchFrames = 120;  ///< of every scene

/// garage, garage_off, room, office. Names of jobs: group and what they are, garage_eps_0.1.
std::vector<BenchGroup> bench_plan(const BenchOptions& options);

}  // namespace engine
