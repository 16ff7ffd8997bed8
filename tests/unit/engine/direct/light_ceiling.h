// A floor under a ceiling of many lights.
#pragma once

#include "tests/unit/engine/direct/lighting_runs.h"

namespace tests {

inline constexpr std::uint32_t kPaint = 0, kFirstLamp = 1;

/// How the lights of a ceiling behave.
struct Ceiling {
  std::uint32_t lights = 1000;
  std::uint32_t materials = 10;  ///< that the lights are dealt out to
  bool moving_card = false;      ///< one between floor and lights, in frames 1 and 2 of 4
  bool take_turns = false;       ///< each material shines in its own frames
  bool moving_lights = false;    ///< every second light is on an object that moves
  bool moving_floor = false;
};

/// A floor of 2 m (material 0, patches of 1 m), lights of 5 cm on a grid over 4 m at a height of 1 to 1.3 m
/// (materials from 1 on, each with a colour of its own), a wall that hides some, 4 frames. Objects: 0 rests,
/// 1 carries lights, 2 is a card, 3 carries the floor.
inline World ceiling(const Ceiling& with) {
  engine::Scene scene = scene_with(4, kFirstLamp + with.materials);
  add_level(scene, {0, 0, 0}, 1, 1, false, with.moving_floor ? 3 : 0);
  add_polygon(scene, {{0.3f, -2, 0.2f}, {0.3f, 2, 0.2f}, {0.3f, 2, 0.8f}, {0.3f, -2, 0.8f}});
  if (with.moving_card) add_level(scene, {0, 0, 0.5f}, 0.4f, 0.7f, true, 2);
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(with.lights))));
  for (std::uint32_t l = 0; l < with.lights; ++l) {
    const auto along = [&](std::uint32_t k) {
      return 4.0f * ((static_cast<float>(k) + 0.5f) / static_cast<float>(side) - 0.5f);
    };
    const float height = 1.0f + 0.1f * static_cast<float>(l % 4);
    const std::uint32_t object = with.moving_lights && l % 2 == 1 ? 1 : 0;
    add_level(scene, {along(l % side), along(l / side), height}, 0.025f, 0.025f, true, object,
              kFirstLamp + l % with.materials);
  }
  engine::Animation animation = still(scene, 4);
  for (std::uint32_t m = 0; m < with.materials; ++m) {
    const float k = static_cast<float>(m + 1);
    const engine::Rgb colour{100 * k, 500 / k, m % 2 == 0 ? 300.0f : 0.0f};
    auto& series = animation.emission.exitance_w_m2[kFirstLamp + m];
    series = {colour};
    if (with.take_turns) {
      series.assign(4, {});
      series[m % 4] = colour;
    }
  }
  const auto moves = [&](std::uint32_t object, double step) {
    animation.objects[object].spans.clear();
    for (engine::FrameIndex f = 0; f < 4; ++f)
      animation.objects[object].spans.push_back({f, f, moved_to(step * f, -step * f, 0)});
  };
  if (with.moving_lights) moves(1, 0.2);
  if (with.moving_floor) moves(3, 0.3);
  if (with.moving_card) animation.objects[2].spans = {{1, 2, {}}};
  return World(std::move(scene), std::move(animation), 1);
}

/// What the ceiling emits in parts of one material each.
inline std::vector<engine::Emission> one_by_one(const World& world) {
  std::vector<engine::Emission> parts;
  const engine::Emission& all = world.animation.emission;
  for (std::size_t m = kFirstLamp; m < all.exitance_w_m2.size(); ++m) {
    engine::Emission part;
    part.exitance_w_m2.assign(all.exitance_w_m2.size(), {{}});
    part.exitance_w_m2[m] = all.exitance_w_m2[m];
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace tests
