// Patches on which something lies: what of them can be seen. Internal to engine/image.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/image/shading_mesh.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// Radiosity is the mean over a patch, and the part under a thing is dark: nodes that took that mean would
/// draw a dark rim, one patch wide, around all that stands on a floor. What can be seen of the patch is
/// brighter,
///
///     sum A_i B_i / sum A_i c_i                                                          [W/m^2]
///
/// over the patches i around a node that are not covered whole; c_i as below, A_i the weight that
/// node_radiosity() gives them.
struct Uncovered {
  std::vector<float> share;          ///< c, [patch]; empty: none is covered
  std::vector<std::uint32_t> nodes;  ///< those with a patch that is covered, in part or whole, and one that
                                     ///< is not covered whole; in order
};

/// c: no facet that rests is within kCoverReach patch edges in front of it; by 16 points, and by 256 where
/// they disagree. Patches that move count as bare, since what covers them changes, and those of materials
/// that emit, since their light is their own.
Uncovered find_uncovered(const Patches& patches, const Animation& animation, const StaticRays& static_rays,
                         const ShadingMesh& mesh);

/// Replaces the values of `uncovered.nodes` in the frames [first_frame, first_frame + values.size()) of
/// `series`. A patch i counts weight(i) A_i c_i below the line.
void show_uncovered(const Uncovered& uncovered, const ShadingMesh& mesh, const Patches& patches,
                    const PatchSeries& series, std::uint32_t first_frame,
                    const std::function<Rgb(PatchId)>& weight, std::span<std::vector<Rgb>> values);

/// Below a twentieth of a patch no light worth speaking of gets in.
inline constexpr float kCoverReach = 0.05f;

}  // namespace engine
