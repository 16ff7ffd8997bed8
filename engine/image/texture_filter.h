// A texture as a pixel sees it. Internal to engine/image.
#pragma once

#include "engine/patches/texture_area.h"

namespace engine {

/// How a point of the texture's plane moves from one sample of the picture to the next, to the right and
/// down: the parallelogram that the sample stands for. Any length, also 0.
struct TextureFootprint {
  TexturePoint right, down;
};

/// Reflectance at `at`, 0 .. kTexelMax, averaged over about the footprint. Magnified: linear between the
/// centres of four texels. Minified: the same on the pyramid's levels, linear between the two whose texels
/// are next to the footprint's width; where it is longer than wide, as on a floor seen from its edge, the
/// mean of up to kProbesMax such values along it, and beyond that blurred.
Rgb filtered_reflectance(const TexturePyramid& texture, TexturePoint at, const TextureFootprint& footprint);

inline constexpr int kProbesMax = 8;

}  // namespace engine
