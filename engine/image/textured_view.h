// What pictures need of textures: irradiance at the nodes instead of radiosity, and the texture in each
// sample.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/image/camera.h"
#include "engine/image/shading_mesh.h"
#include "engine/image/uncovered.h"
#include "engine/patches/texture_reflectance.h"

namespace engine {

/// A facet that shows a texture has at a point
///
///     B = E + rho(u, v) H                                                                [W/m^2]
///
/// E    exitance of its material in the frame, of fronts only                             [W/m^2]
/// rho  the texture itself                                                                [-]
/// H    irradiance, interpolated between the nodes around                                 [W/m^2]
///
/// and a node has, of the patches i around it and in each channel
///
///     H = sum A_i w_i (B_i - E) / rho_i / sum A_i w_i,    w_i = min(rho_i / 0.01, 1)
///
/// so patches that reflect next to nothing, whose H is a little divided by a little, count as little, and
/// those that reflect nothing not at all. A node with only such around it has H = 0, and is seen on them
/// alone.
struct TexturedView {
  const Animation& animation;
  const Patches& patches;
  const ShadingMesh& mesh;
  std::vector<TexturePyramid> pyramids;  ///< [texture], empty where not in use
  std::vector<FacetTexture> facet_textures;
  std::vector<std::uint32_t> facet_texture_of;  ///< [facet]: into facet_textures, or kNoIndex
  std::vector<char> shows_irradiance;  ///< [node]: its facets show a texture; they share the material
  std::vector<Rgb> weight;             ///< [node]: sum A_i w_i / sum A_i

  bool is_textured(std::uint32_t facet) const { return facet_texture_of[facet] != kNoIndex; }
  /// Where node values hold the exitance of a facet's material.
  std::uint32_t exitance_value(std::uint32_t facet) const {
    return mesh.node_count + patches.facets[facet].material;
  }
};

/// Null where patches.texture_reflectance is empty. All but the scene outlives it, and Scene::textures too.
std::unique_ptr<TexturedView> make_textured_view(const Scene& scene, const Animation& animation,
                                                 const Patches& patches, const ShadingMesh& mesh);

/// As node_radiosity() and, with `uncovered`, show_uncovered(), but H where nodes show irradiance, and after
/// the nodes' values the exitance of each material, so that each values[k] has the size node_count + number
/// of materials.  [W/m^2] radiosity_w_m2: of everything that `animation` lets emit; its column
/// first_column + k is that of the frame frames[k].
bool textured_node_values(const TexturedView& view, const Uncovered& uncovered,
                          const PatchSeries& radiosity_w_m2, std::uint32_t first_column,
                          std::span<const FrameIndex> frames, const std::function<bool()>& stop_requested,
                          std::span<std::vector<Rgb>> values_w_m2);

/// What a sample of the picture meets.
struct TexturedHit {
  SurfaceHit at;  ///< of `ray`, on a textured facet
  Ray ray;        ///< of `camera`
  FrameIndex frame = 0;
};

/// rho averaged over what one of `samples_per_pixel` samples stands for, see filtered_reflectance().
Rgb reflectance_in_sample(const TexturedView& view, const TexturedHit& hit, const PinholeCamera& camera,
                          std::uint32_t samples_per_pixel);

}  // namespace engine
