// A small scene, its motion and a radiosity that tells patch and frame, for the tests of written files.
#pragma once

#include "engine/animation/animation.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace tests {

/// Object 0 "Fußboden": a rectangle 2 m x 1 m at z = 0, both sides. Object 1 "wing \"left\"": a right
/// triangle of legs 1 m, front only.
inline engine::Scene sample_scene() {
  engine::Scene scene;
  scene.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  scene.corners = {0, 1, 2, 3, 4, 5, 6};
  scene.polygons = {{0, 4, 0, 0, 1}, {4, 3, 1, 1, 2}};
  scene.objects = {{"Fußboden"}, {"wing \"left\""}};
  scene.materials = {{"concrete", {0.3f, 0.3f, 0.3f}, {}, true}, {"paint", {0.6f, 0.1f, 0.1f}, {}, false}};
  return scene;
}

/// 3 frames: the floor rests; the wing stands at x = 10 in frame 0, is away in 1, and at x = 30 in 2.
inline engine::Animation sample_animation() {
  engine::Animation animation;
  animation.frame_count = 3;
  engine::Pose at_10, at_30;
  at_10.m[0][3] = 10;
  at_30.m[0][3] = 30;
  animation.objects = {{{{0, 2, {}}}}, {{{0, 0, at_10}, {2, 2, at_30}}}};
  animation.emission.exitance_w_m2 = {{{}}, {{}}};
  return animation;
}

/// B(patch, frame) = (patch + 1000 frame, -patch, 0.5)  [W/m^2]
inline engine::PatchSeries numbered_series(std::uint32_t patches, std::uint32_t frames) {
  engine::PatchSeries series(patches, frames);
  for (std::uint32_t p = 0; p < patches; ++p)
    for (std::uint32_t f = 0; f < frames; ++f)
      series.at(p, f) = {static_cast<float>(p + 1000 * f), -static_cast<float>(p), 0.5f};
  return series;
}

}  // namespace tests
