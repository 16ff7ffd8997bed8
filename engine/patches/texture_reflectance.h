// What textures mean for patches: where a facet lies on its texture, and the reflectance of each patch.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"
#include "engine/patches/texture_area.h"
#include "engine/scene/scene.h"

namespace engine {

/// Where a facet lies on the texture of its material.
struct FacetTexture {
  std::uint32_t texture = 0;            ///< into Scene::textures
  std::array<TexturePoint, 4> corners;  ///< in the order of Facet::corners

  /// Linear between the corners of a triangle, bilinear between those of a parallelogram.
  TexturePoint at(const Facet& facet, double u, double v) const;
};

/// None where the material has no texture, or the animation gives it a reflectance, or the OBJ gives the
/// polygon no texture coordinates.
std::optional<FacetTexture> facet_texture(const Scene& scene, const Animation& animation, const Facet& facet);

/// For each of Facet::corners the corner of its polygon that is there, into Scene::corners; 3 for a triangle.
std::array<std::uint32_t, 4> polygon_corners(const Scene& scene, const Facet& facet);

/// Reflectance of every patch, [patch], 0 .. kTexelMax where a texture gives it: the mean over its cell, see
/// mean_over_triangle. Elsewhere it is the material's (where the animation keys it, that of frame 0). Empty
/// where no facet has a texture. Two triangles stand for a cell of a parallelogram; where the texture's
/// corners are no parallelogram themselves the mean is that of the texture drawn straight on these triangles.
std::vector<Rgb> texture_reflectance(const Scene& scene, const Animation& animation, const Patches& patches);

/// Reflectance of a patch in a frame: keyed, or of its texture, or of its material.
inline Rgb patch_reflectance(const Scene& scene, const Animation& animation, const Patches& patches,
                             PatchId patch, FrameIndex frame) {
  const std::uint32_t material = patches.facets[patches.facet_of[patch]].material;
  const bool keyed = material < animation.reflectance.size() && !animation.reflectance[material].empty();
  if (keyed || patches.texture_reflectance.empty())
    return material_reflectance(scene, animation, material, frame);
  return patches.texture_reflectance[patch];
}

}  // namespace engine
