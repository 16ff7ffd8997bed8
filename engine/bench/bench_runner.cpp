#include "engine/bench/bench_runner.h"

#include <cstdio>

namespace engine {

BenchRunner runner_of(const BenchOptions& options, const std::filesystem::path& program) {
  const auto out = std::filesystem::absolute(options.out_folder);
  return {program, options.examples_folder, out / "jobs"};
}

api::Result<BenchRun> run_job(const BenchJob& job, const BenchRunner& runner, int repetitions) {
  auto run = run_bench_job(job, runner.examples, runner.jobs / job.name, runner.program, repetitions);
  if (run)
    std::fprintf(stderr, "%-28s %2d. %8.2f s, %5.0f MB\n", job.name.c_str(), run->repetitions,
                 run->times.back().estimation_s + run->times.back().computation_s,
                 static_cast<double>(run->peak_memory_bytes) / 1e6);
  else
    std::fprintf(stderr, "%-28s %s\n", job.name.c_str(), run.error().message.c_str());
  return run;
}

std::vector<api::Result<BenchRun>> run_in_turn(const std::vector<BenchJob>& jobs, const BenchRunner& runner,
                                               int repetitions) {
  std::vector<api::Result<BenchRun>> runs;
  for (const BenchJob& job : jobs) runs.push_back(run_job(job, runner, 1));
  for (int done = 1; done < repetitions; ++done)
    for (std::size_t k = 0; k < jobs.size(); ++k)
      if (runs[k] && runs[k]->repetitions <= done) runs[k] = run_job(jobs[k], runner, done + 1);
  return runs;
}

}  // namespace engine
