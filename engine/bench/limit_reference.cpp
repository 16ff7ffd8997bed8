#include "engine/bench/limit_reference.h"

#include "engine/bench/bench_scene.h"
#include "engine/bench/limit_plan.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

/// All, at rest, moving.
std::vector<PatchWeights> weight_sets(const BenchScene& scene) {
  const PatchWeights all = patch_weights(scene);
  std::vector<PatchWeights> sets{all, all, all};
  for (PatchId patch = 0; patch < scene.patches.count(); ++patch) {
    const Facet& facet = scene.patches.facets[scene.patches.facet_of[patch]];
    const bool rests = scene.animation.objects[facet.object].is_static(scene.animation.frame_count);
    sets[rests ? 2 : 1][patch] = 0;
  }
  return sets;
}

api::Result<LimitError> relative_errors(std::span<const PatchWeights> sets, const fs::path& values,
                                        const fs::path& reference, std::span<const FramePair> frames) {
  const auto sums = compare_sequences(sets, values, reference, frames);
  if (!sums) return sums.error();
  const double mean = (*sums)[0].mean_w_m2();
  return LimitError{(*sums)[0].rmse_w_m2() / mean, (*sums)[1].rmse_w_m2() / mean,
                    (*sums)[2].rmse_w_m2() / mean};
}

fs::path radiosity_of(const BenchRun& run) {
  return run.folder / "artefacts/radiosity.npy";
}

}  // namespace

api::Result<LimitReference> make_reference(LimitBench& bench) {
  std::vector<BenchRun> halves;
  for (const int half : {1, 2}) {
    BenchJob job =
        limit_job("converged_" + std::to_string(half), converged_half(bench.options.quick), bench.options);
    constexpr std::uint64_t kSeeds = std::uint64_t{1} << 53;
    job.lighting.seed =
        (job.lighting.seed + 1000u * static_cast<unsigned>(half)) % kSeeds;  // not a measured one
    job.any_program = true;
    auto run = run_job(job, bench.runner, 1);
    if (!run) return run.error();
    halves.push_back(std::move(*run));
  }
  const auto scene = load_bench_scene(halves[0].folder / "input");
  if (!scene) return scene.error();
  LimitReference reference{bench.runner.jobs / "converged.npy", weight_sets(*scene), {}};
  if (const auto s = write_mean(radiosity_of(halves[0]), radiosity_of(halves[1]), reference.radiosity); !s)
    return s.error();
  const auto apart = relative_errors(reference.sets, radiosity_of(halves[0]), radiosity_of(halves[1]), {});
  if (!apart) return apart.error();
  reference.noise = {apart->total / 2, apart->at_rest / 2, apart->moving / 2};
  return reference;
}

api::Result<LimitError> error_against(const LimitReference& reference, const BenchRun& run,
                                      std::span<const FramePair> frames) {
  return relative_errors(reference.sets, radiosity_of(run), reference.radiosity, frames);
}

api::Result<LimitError> error_between(const LimitReference& reference, const BenchRun& run,
                                      const fs::path& other) {
  return relative_errors(reference.sets, radiosity_of(run), other, {});
}

}  // namespace engine
