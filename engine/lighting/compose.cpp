#include "engine/lighting/compose.h"

#include <algorithm>

#include "engine/base/parallel.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// [object][position in `frames`]: is it there?
std::vector<std::vector<bool>> presence(const Animation& animation, std::span<const FrameIndex> frames) {
  std::vector<std::vector<bool>> there(animation.objects.size(), std::vector<bool>(frames.size(), false));
  for (std::size_t object = 0; object < there.size(); ++object)
    for (const PlacedRange& range : placed_ranges(animation.objects[object], frames))
      std::fill(there[object].begin() + range.first_slot, there[object].begin() + range.last_slot + 1, true);
  return there;
}

/// Sets every value to make(patch, position) where the patch's object is there, to 0 elsewhere.
template <class Make>
void fill(const LitScene& lit, std::span<const FrameIndex> frames, PatchSeries& series, Make&& make) {
  const auto there = presence(lit.animation, frames);
  parallel_for(lit.patches.facets.size(), [&](std::size_t f) {
    const Facet& facet = lit.patches.facets[f];
    for (PatchId patch = facet.first_patch; patch < facet.first_patch + facet.patch_count(); ++patch)
      for (std::uint32_t k = 0; k < frames.size(); ++k)
        series.at(patch, k) = there[facet.object][k] ? make(patch, k) : Rgb{};
  });
}

}  // namespace

PatchSeries compose_radiosity(const LitScene& lit, std::span<const FrameIndex> frames,
                              const PatchSeries* direct, const PatchSeries& indirect) {
  PatchSeries radiosity(lit.patches.count(), static_cast<std::uint32_t>(frames.size()));
  const std::vector<Rgb> reflectance = reflectance_of_patches(lit.scene, lit.patches);
  fill(lit, frames, radiosity, [&](PatchId patch, std::uint32_t k) {
    const Rgb arriving = direct ? direct->at(patch, k) + indirect.at(patch, k) : indirect.at(patch, k);
    return exitance_of_patch(lit, patch, frames[k]) + reflectance[patch] * arriving;
  });
  return radiosity;
}

void reflect(const LitScene& lit, std::span<const FrameIndex> frames, PatchSeries& irradiance) {
  const std::vector<Rgb> reflectance = reflectance_of_patches(lit.scene, lit.patches);
  fill(lit, frames, irradiance,
       [&](PatchId patch, std::uint32_t k) { return reflectance[patch] * irradiance.at(patch, k); });
}

}  // namespace engine
