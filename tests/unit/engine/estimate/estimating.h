// Estimates of small rooms, for the tests of the estimate.
#pragma once

#include <memory>

#include "engine/animation/light_groups.h"
#include "engine/estimate/estimate_lighting.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace tests {

inline api::LightingOptions options_with(api::DirectLight direct, api::Interpolated interpolated,
                                         std::uint64_t seed = 1) {
  api::LightingOptions options;
  options.direct = direct;
  options.interpolated = interpolated;
  options.estimate_patch_edge_m = 1;
  options.seed = seed;
  return options;
}

inline engine::Estimator begin_estimate(const World& world, const api::LightingOptions& options,
                                        const engine::Progress& progress = {},
                                        const engine::EstimateCheckpoints& checkpoints = {}) {
  const auto groups =
      engine::light_groups(world.scene, world.animation, options.light_groups, engine::kScaledGroupsMax);
  auto estimator = engine::Estimator::begin(world.scene, world.animation, world.static_rays, groups, options,
                                            progress, checkpoints);
  EXPECT_TRUE(estimator);
  return std::move(*estimator);
}

/// Lit by a lamp that blinks, which is a group of its own, and one that does not.
inline std::unique_ptr<World> blinking_room(engine::FrameIndex frames) {
  engine::Scene scene = lit_room_scene(false);
  scene.materials.push_back({"blinking", {0.1f, 0.1f, 0.1f}, {}, false});
  add_polygon(scene, {{-1.4f, -1.0f, 1.8f}, {-1.4f, -0.6f, 1.8f}, {-1.0f, -0.6f, 1.8f}, {-1.0f, -1.0f, 1.8f}},
              0, 3);
  engine::Animation animation = lit_room_animation(scene, frames);
  animation.emission.exitance_w_m2.resize(4);
  for (engine::FrameIndex f = 0; f < frames; ++f)
    animation.emission.exitance_w_m2[3].push_back(engine::Rgb{4, 6, 8} * (f % 3 == 0 ? 0.0f : 1.0f));
  return std::make_unique<World>(scene, animation, 1.0);
}

}  // namespace tests
