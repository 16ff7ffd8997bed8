#include "engine/estimate/estimate_lighting.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "engine/base/sobol.h"
#include "engine/direct/direct_light.h"
#include "engine/estimate/replicates.h"
#include "engine/lighting/compose.h"

namespace engine {
namespace {

/// Shadow rays per light and coarse patch. A patch of metres stands for many fine ones: it gets more rays
/// than one of them, and all of them together are still few.
constexpr std::uint32_t kSamplesPerLight = 32;

/// Direct light is about this share of the estimate's time; progress only.
constexpr double kDirectShare = 0.5;

/// The indirect light of all frames from kReplicates independent sets of lines.
api::Status add_indirect(const LitScene& lit, std::span<const FrameIndex> frames, const PatchSeries* direct,
                         const api::LightingOptions& options, const Progress& progress, Estimate& estimate) {
  Replicates irradiance;
  const std::uint64_t lines = std::max<std::uint64_t>(1, options.estimate_line_count / kReplicates);
  for (std::uint32_t k = 0; k < kReplicates; ++k) {
    const auto share = [&](std::uint32_t i) { return static_cast<double>(i) / kReplicates; };
    auto indirect = indirect_light(lit, frames, direct, {lines, stream_seed(options.seed, k)},
                                   part_of(progress, share(k), share(k + 1)));
    if (!indirect) return indirect.error();
    irradiance.add(std::move(indirect->irradiance_w_m2));
  }
  estimate.indirect_w_m2 = irradiance.mean();
  estimate.noise_w_m2 = irradiance.noise_in_time(estimate.indirect_w_m2);
  const std::vector<Rgb> reflectance = reflectance_of_patches(lit.scene, lit.patches);
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch)
    estimate.noise_w_m2[patch] *= max_channel(reflectance[patch]);
  return api::Done{};
}

}  // namespace

api::Result<Estimate> estimate_lighting(const Scene& scene, const Animation& animation,
                                        const StaticRays& static_rays, const api::LightingOptions& options,
                                        const Progress& progress) {
  auto patches = mesh_into_patches(scene, options.estimate_patch_edge_m);
  if (!patches) return patches.error();
  Estimate estimate;
  estimate.patches = std::move(*patches);
  const LitScene lit{scene, animation, estimate.patches, static_rays};
  std::vector<FrameIndex> frames(animation.frame_count);
  std::iota(frames.begin(), frames.end(), 0u);

  PatchSeries direct;
  const bool apart = options.direct == api::DirectLight::apart;
  if (apart) {
    auto lit_directly = direct_light(estimate.patches, animation, static_rays, frames,
                                     {kSamplesPerLight, options.seed}, part_of(progress, 0, kDirectShare));
    if (!lit_directly) return lit_directly.error();
    direct = std::move(*lit_directly);
  }
  const PatchSeries* first_shot = apart ? &direct : nullptr;
  const Progress rest = part_of(progress, apart ? kDirectShare : 0, 1);
  if (const auto s = add_indirect(lit, frames, first_shot, options, rest, estimate); !s) return s.error();
  estimate.radiosity_w_m2 = compose_radiosity(lit, frames, first_shot, estimate.indirect_w_m2);
  reflect(lit, frames, estimate.indirect_w_m2);
  return estimate;
}

}  // namespace engine
