// Jobs of a bench beside each other: where they lie, and in which order they run.
#pragma once

#include <filesystem>
#include <vector>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_options.h"

namespace engine {

/// What all jobs of a bench share.
struct BenchRunner {
  std::filesystem::path program;
  std::filesystem::path examples;  ///< folder of the scenes that jobs name
  std::filesystem::path jobs;      ///< made: a folder per job
};

BenchRunner runner_of(const BenchOptions& options, const std::filesystem::path& program);

/// As run_bench_job; tells on standard error how it went.
api::Result<BenchRun> run_job(const BenchJob& job, const BenchRunner& runner, int repetitions);

/// Each job `repetitions` times, in turn: A B C A B C ..., so that what disturbs the machine for a while
/// disturbs all of them. [job]; a job that fails is not run again.
std::vector<api::Result<BenchRun>> run_in_turn(const std::vector<BenchJob>& jobs, const BenchRunner& runner,
                                               int repetitions);

}  // namespace engine
