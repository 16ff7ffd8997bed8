#include "engine/lighting/lit_scene.h"

namespace engine {

std::vector<Rgb> reflectance_at_rest(const LitScene& lit) {
  std::vector<Rgb> reflectance(lit.patches.count());
  const FrameIndex frames = lit.animation.frame_count;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (!lit.at_rest(patch)) continue;
    if (!lit.has_keyed_reflectance(patch)) {
      reflectance[patch] = lit.reflectance(patch, 0);
      continue;
    }
    for (FrameIndex f = 0; f < frames; ++f) reflectance[patch] += lit.reflectance(patch, f);
    reflectance[patch] = reflectance[patch] * (1.0f / static_cast<float>(frames));
  }
  return reflectance;
}

}  // namespace engine
