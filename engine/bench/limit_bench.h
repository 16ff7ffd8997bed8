// `keylume bench limit` in parts. Each adds its tables and bars to the sheet.
#pragma once

#include "engine/bench/bench_runner.h"
#include "engine/bench/bench_sheet.h"

namespace engine {

struct LimitBench {
  BenchOptions options;  ///< examples_folder is set
  BenchRunner runner;
  BenchSheet sheet;

  int repetitions() const { return options.quick ? 1 : options.repetitions; }
};

/// Time and memory to an error; what standard errors add; speed-up against frames one by one; what choosing
/// key-frames costs and gains.
api::Status measure_solve(LimitBench& bench);

/// All hits along global lines against raw Embree on the same lines, in the garage and in the office.
api::Status measure_lines(LimitBench& bench);

/// What three channels cost beside one, where a kernel lets itself be fed with either.
api::Status measure_channels(LimitBench& bench);

/// Pictures per second.
api::Status measure_images(LimitBench& bench);

/// A large OBJ, read and cut into patches.
api::Status measure_load(LimitBench& bench);

}  // namespace engine
