#include "engine/lighting/sources.h"

#include "engine/animation/light_groups.h"

namespace engine {

std::vector<Rgb> reflectance_at_rest(const LitScene& lit) {
  std::vector<Rgb> reflectance(lit.patches.count());
  const FrameIndex frames = lit.animation.frame_count;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (!lit.at_rest(patch)) continue;
    const std::uint32_t material = lit.material_of(patch);
    const bool keyed =
        material < lit.animation.reflectance.size() && lit.animation.reflectance[material].size() > 1;
    if (!keyed) {
      reflectance[patch] = lit.reflectance(patch, 0);
      continue;
    }
    for (FrameIndex f = 0; f < frames; ++f) reflectance[patch] += lit.reflectance(patch, f);
    reflectance[patch] = reflectance[patch] * (1.0f / static_cast<float>(frames));
  }
  return reflectance;
}

Rgb GroupSource::in_frame(const LitScene& lit, PatchId patch, FrameIndex frame) const {
  if (!direct) return lit.exitance(*emission, patch, frame);
  return lit.reflectance(patch, frame) * direct_in_frame(patch, frame);
}

std::vector<Rgb> source_at_rest(const LitScene& lit, const GroupSource& source,
                                std::span<const Rgb> reflectance_at_rest) {
  std::vector<Rgb> at_rest(lit.patches.count());
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (!lit.at_rest(patch)) continue;
    if (source.direct)
      at_rest[patch] = reflectance_at_rest[patch] * source.direct->at_rest_w_m2[patch];
    else if (!lit.patches.is_back(patch))
      at_rest[patch] = mean_exitance(*source.emission, lit.material_of(patch));
  }
  return at_rest;
}

}  // namespace engine
