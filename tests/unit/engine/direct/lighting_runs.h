// Scenes lit directly, for the tests of direct light.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

#include "engine/direct/direct_light.h"
#include "tests/support/statistics.h"
#include "tests/unit/engine/scenes.h"

namespace tests {

inline engine::DirectLight light_directly(const World& world, const engine::Emission& emission,
                                          const std::vector<engine::FrameIndex>& frames,
                                          const engine::DirectOptions& options = {}) {
  auto lit =
      engine::direct_light(world.patches, world.animation, emission, world.static_rays, frames, options, {});
  EXPECT_TRUE(lit);
  return std::move(*lit);
}

inline engine::DirectLight light_directly(const World& world, const std::vector<engine::FrameIndex>& frames,
                                          const engine::DirectOptions& options = {}) {
  return light_directly(world, world.animation.emission, frames, options);
}

inline float channel(engine::Rgb value, int c) {
  return c == 0 ? value.r : c == 1 ? value.g : value.b;
}

/// Patches whose facet has this material.
inline std::vector<engine::PatchId> patches_of(const World& world, std::uint32_t material) {
  std::vector<engine::PatchId> found;
  for (engine::PatchId patch = 0; patch < world.patches.count(); ++patch)
    if (world.patches.facets[world.patches.facet_of[patch]].material == material) found.push_back(patch);
  return found;
}

/// A level rectangle about (x, y) that looks down, or up.
inline void add_level(engine::Scene& scene, Vec3 middle, float half_x, float half_y, bool down,
                      std::uint32_t object = 0, std::uint32_t material = 0) {
  const Vec3 x{half_x, 0, 0}, y{0, half_y, 0};
  const Vec3 a = middle - x - y, b = middle + x - y, c = middle + x + y, d = middle - x + y;
  if (down)
    add_polygon(scene, {a, d, c, b}, object, material);
  else
    add_polygon(scene, {a, b, c, d}, object, material);
}

}  // namespace tests
