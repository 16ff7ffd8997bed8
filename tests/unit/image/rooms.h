// Scenes of quads and boxes, built by hand, for the tests of images.
#pragma once

#include <array>
#include <functional>

#include "engine/animation/animation.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace tests {

using engine::Vec3;

/// Adds a polygon; its corners are counter-clockwise seen from its front.
inline void add_polygon(engine::Scene& scene, std::initializer_list<Vec3> corners, std::uint32_t object = 0,
                        std::uint32_t material = 0) {
  scene.polygons.push_back({static_cast<std::uint32_t>(scene.corners.size()),
                            static_cast<std::uint32_t>(corners.size()), object, material, 1});
  for (const Vec3 corner : corners) {
    scene.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(corner);
  }
}

/// The six faces of a box; their fronts are inside (a room) or outside (a thing).
inline void add_box(engine::Scene& scene, Vec3 low, Vec3 high, bool inward, std::uint32_t object = 0,
                    std::uint32_t material = 0) {
  const auto corner = [&](int c) {
    return Vec3{c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z};
  };
  constexpr std::array<std::array<int, 4>, 6> kOutwardFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& face : kOutwardFaces) {
    const Vec3 a = corner(face[0]), b = corner(face[1]), c = corner(face[2]), d = corner(face[3]);
    if (inward)
      add_polygon(scene, {d, c, b, a}, object, material);
    else
      add_polygon(scene, {a, b, c, d}, object, material);
  }
}

inline engine::Scene scene_with(std::uint32_t objects, std::uint32_t materials, bool both_sides = false) {
  engine::Scene scene;
  scene.objects.resize(objects);
  for (std::uint32_t m = 0; m < materials; ++m)
    scene.materials.push_back({"paint", {0.5f, 0.5f, 0.5f}, {}, both_sides});
  return scene;
}

/// Every object rests.
inline engine::Animation still(const engine::Scene& scene, engine::FrameIndex frames) {
  engine::Animation animation;
  animation.frame_count = frames;
  animation.objects.assign(scene.objects.size(), {{{0, frames - 1, {}}}});
  animation.emission.exitance_w_m2.assign(scene.materials.size(), {{}});
  return animation;
}

inline engine::Pose moved_to(double x, double y, double z) {
  engine::Pose pose;
  pose.m[0][3] = x;
  pose.m[1][3] = y;
  pose.m[2][3] = z;
  return pose;
}

inline Vec3 centre_of(const engine::Patches& patches, engine::PatchId patch) {
  const engine::Facet& facet = patches.facets[patches.facet_of[patch]];
  const engine::CellCorners corners = engine::cell_corners(facet, patches.cell_of(patch));
  Vec3 sum;
  for (std::uint32_t c = 0; c < corners.count; ++c)
    sum = sum + facet.origin + corners.u[c] * facet.edge_u + corners.v[c] * facet.edge_v;
  return sum * (1.0f / static_cast<float>(corners.count));
}

/// B(patch) = field(centre of the patch) in every frame.
inline engine::PatchSeries series_of(const engine::Patches& patches, std::uint32_t frames,
                                     const std::function<engine::Rgb(engine::PatchId, Vec3)>& field) {
  engine::PatchSeries series(patches.count(), frames);
  for (engine::PatchId p = 0; p < patches.count(); ++p)
    for (std::uint32_t f = 0; f < frames; ++f) series.at(p, f) = field(p, centre_of(patches, p));
  return series;
}

}  // namespace tests
