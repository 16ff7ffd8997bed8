// A floor patch in the half shadow of a square light.
#pragma once

#include <array>

#include "engine/direct/form_factor.h"
#include "tests/unit/engine/scenes.h"

namespace tests {

inline constexpr engine::PatchId kFloor = 0;
inline constexpr engine::Rgb kExitance{10, 5, 1};
inline constexpr float kHalf = 0.5f, kHeight = 2, kFloorHalf = 0.25f;

/// Object 0: a floor patch of 0.5 m that faces up, lit by a light of 1 m, 2 m above it, that faces down
/// (material 1). Object 1: whatever the tests put between them; it rests unless they move it.
inline engine::Scene floor_and_light(bool both_sides = false) {
  engine::Scene scene = scene_with(2, 2, both_sides);
  add_polygon(scene, {{-kFloorHalf, -kFloorHalf, 0},
                      {kFloorHalf, -kFloorHalf, 0},
                      {kFloorHalf, kFloorHalf, 0},
                      {-kFloorHalf, kFloorHalf, 0}});
  add_polygon(scene,
              {{-kHalf, kHalf, kHeight},
               {kHalf, kHalf, kHeight},
               {kHalf, -kHalf, kHeight},
               {-kHalf, -kHalf, kHeight}},
              0, 1);
  return scene;
}

inline engine::Animation lit_from_above(const engine::Scene& scene, engine::FrameIndex frames) {
  engine::Animation animation = still(scene, frames);
  animation.emission.exitance_w_m2[1] = {kExitance};
  return animation;
}

/// A sheet at half the height, from x = low to beyond everything.
inline void add_blocker(engine::Scene& scene, float low, std::uint32_t object = 1) {
  add_polygon(scene, {{low, -9, 1}, {9, -9, 1}, {9, 9, 1}, {low, 9, 1}}, object);
}

/// What of the light a point sees past a blocker whose edge is at x = low: its form factor.
inline double visible_factor(Vec3 point, float low) {
  const float cut = std::clamp(2 * low - point.x, -kHalf, kHalf);  // the edge's shadow on the light's plane
  const std::array<Vec3, 4> rest{
      Vec3{-kHalf, kHalf, kHeight}, {cut, kHalf, kHeight}, {cut, -kHalf, kHeight}, {-kHalf, -kHalf, kHeight}};
  return cut > -kHalf ? engine::point_to_polygon_form_factor(point, {0, 0, 1}, rest) : 0;
}

/// Mean over the floor patch moved by `x`, by the midpoint rule.
inline double mean_visible_factor(float low, float x = 0) {
  constexpr int kSteps = 100;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const auto at = [](int k) { return kFloorHalf * (2 * (static_cast<float>(k) + 0.5f) / kSteps - 1); };
      sum += visible_factor({x + at(i), at(j), 0}, low);
    }
  return sum / (kSteps * kSteps);
}

}  // namespace tests
