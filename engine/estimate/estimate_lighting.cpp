#include "engine/estimate/estimate_lighting.h"

#include <numeric>

#include "engine/direct/direct_light.h"
#include "engine/lighting/compose.h"

namespace engine {
namespace {

/// Shadow rays per light and coarse patch. A patch of metres stands for many fine ones: it gets more rays
/// than one of them, and all of them together are still few.
constexpr std::uint32_t kSamplesPerLight = 32;

/// Direct light is about this share of the estimate's time; progress only.
constexpr double kDirectShare = 0.5;

}  // namespace

api::Result<Estimate> estimate_lighting(const Scene& scene, const Animation& animation,
                                        const StaticRays& static_rays, const api::LightingOptions& options,
                                        const Progress& progress) {
  auto patches = mesh_into_patches(scene, options.estimate_patch_edge_m);
  if (!patches) return patches.error();
  Estimate estimate{std::move(*patches), {}, {}, {}};
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
  auto indirect =
      indirect_light(lit, frames, apart ? &direct : nullptr, {options.estimate_line_count, options.seed},
                     part_of(progress, apart ? kDirectShare : 0, 1));
  if (!indirect) return indirect.error();
  estimate.counts = indirect->counts;
  estimate.radiosity_w_m2 =
      compose_radiosity(lit, frames, apart ? &direct : nullptr, indirect->irradiance_w_m2);
  estimate.indirect_w_m2 = std::move(indirect->irradiance_w_m2);
  reflect(lit, frames, estimate.indirect_w_m2);
  return estimate;
}

}  // namespace engine
