#include "engine/bench/bench_results.h"

#include <cstdio>

namespace engine {
namespace {

/// Those that take longer are run once: they are far above what the clock and other processes do to them.
constexpr double kRepeatedSecondsMax = 60;
constexpr int kRepetitions = 3;

api::Result<BenchRun> run_one(const BenchJob& job, const BenchOptions& options,
                              const std::filesystem::path& program) {
  const auto folder = std::filesystem::absolute(options.out_folder) / "jobs" / job.name;
  auto run = run_bench_job(job, options.examples_folder, folder, program, 1);
  if (run && !options.quick && run->estimation_s + run->computation_s < kRepeatedSecondsMax)
    run = run_bench_job(job, options.examples_folder, folder, program, kRepetitions);
  if (run)
    std::fprintf(stderr, "%-20s %3zu frames solved, %8.2f s, %5.0f MB\n", job.name.c_str(),
                 solved_frames(run->key_frames), run->estimation_s + run->computation_s,
                 static_cast<double>(run->peak_memory_bytes) / 1e6);
  return run;
}

api::Status compare_run(const PatchWeights& weights, const std::filesystem::path& reference,
                        RunResult& result) {
  auto error =
      sequence_error(weights, result.run.folder / "artefacts/radiosity.npy", reference, kBenchTolerance);
  if (!error) return error.error();
  result.error = std::move(*error);
  return api::Done{};
}

/// Equation (2) speaks of runs in which all that a frame costs is solved for it: not of mode `default`, whose
/// direct light is that of every frame.
CostFit fit_group(const GroupResult& group) {
  std::vector<CostPoint> points;
  for (const RunResult& result : group.runs)
    if (result.run.key_frames.mode != api::LightingMode::standard)
      points.push_back({static_cast<double>(solved_frames(result.run.key_frames)), result.run.computation_s});
  constexpr std::size_t kPointsMin = 3;  // through two every line fits
  return points.size() < kPointsMin ? CostFit{} : fit_cost(points);
}

}  // namespace

const RunResult* find_run(const std::vector<GroupResult>& groups, const std::string& name) {
  for (const GroupResult& group : groups)
    for (const RunResult& result : group.runs)
      if (result.run.name == name) return &result;
  return nullptr;
}

api::Result<GroupResult> run_group(const BenchGroup& group, const BenchOptions& options,
                                   const std::filesystem::path& program) {
  GroupResult result{group.name, {}, {}, 0, {}, {}, static_cast<double>(group.full.lighting.line_count)};
  auto full = run_one(group.full, options, program);
  if (!full) return full.error();
  result.runs.push_back({std::move(*full), {}});
  auto alone = run_one(group.alone, options, program);
  if (!alone) return alone.error();
  result.alone = std::move(*alone);
  result.alone_s = result.alone.computation_s * kBenchFrames / static_cast<double>(group.alone.frames.size());
  for (const BenchJob& job : group.runs) {
    auto run = run_one(job, options, program);
    if (!run) return run.error();
    result.runs.push_back({std::move(*run), {}});
  }

  const auto scene = load_bench_scene(result.runs[0].run.folder / "input");
  if (!scene) return scene.error();
  result.numbers = scene_numbers(*scene);
  const PatchWeights weights = patch_weights(*scene);
  const auto reference = result.runs[0].run.folder / "artefacts/radiosity.npy";
  for (RunResult& run : result.runs) {
    if (const auto s = compare_run(weights, reference, run); !s) return s.error();
    run.absolute_speed_up = result.alone_s / run.seconds();
    run.relative_speed_up = result.runs[0].seconds() / run.seconds();
  }
  result.cost = fit_group(result);
  return result;
}

}  // namespace engine
