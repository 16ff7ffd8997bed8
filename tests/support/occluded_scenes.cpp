#include "tests/support/occluded_scenes.h"

#include <array>

namespace tests {
namespace {

using engine::FrameIndex;
using engine::Rgb;

/// A room of 3 x 2 x 2 m with a lamp of .6 m that hangs `hanging_m` below its ceiling.
SceneBuilder lit_room(FrameIndex frame_count, const std::array<Rgb, 6>& walls, Rgb lamp_w_m2,
                      float hanging_m) {
  SceneBuilder built(frame_count);
  std::array<std::uint32_t, 6> paint{};
  for (std::size_t k = 0; k < 6; ++k) paint[k] = built.add_material(walls[k]);
  built.add_box({0, 0, 0}, {3, 2, 2}, true, paint);
  const auto lamp = built.add_material({}, lamp_w_m2);
  const float z = 2 - hanging_m;
  built.add_polygon({{1.2f, 0.7f, z}, {1.2f, 1.3f, z}, {1.8f, 1.3f, z}, {1.8f, 0.7f, z}}, lamp);
  return built;
}

std::array<Rgb, 6> all_walls(Rgb reflectance) {
  return {reflectance, reflectance, reflectance, reflectance, reflectance, reflectance};
}

}  // namespace

SceneBuilder blocks_of_which_one_moves() {
  SceneBuilder built = lit_room(2, all_walls({0.6f, 0.6f, 0.6f}), {10, 10, 10}, 0.3f);
  const auto paint = built.add_material({0.4f, 0.4f, 0.4f});
  built.add_box({0.4f, 0.4f, 0.3f}, {0.9f, 1.0f, 1.2f}, false, paint);
  const auto mover = built.add_object(
      {{{0, 0, turned_and_moved(0, 1.5, 1.4, 0.8)}, {1, 1, turned_and_moved(0.6, 2.2, 0.7, 1.1)}}});
  built.add_box({-0.3f, -0.2f, -0.25f}, {0.3f, 0.2f, 0.25f}, false, paint, mover);
  return built;
}

SceneBuilder open_sheet() {
  SceneBuilder built = lit_room(1, all_walls({0.5f, 0.5f, 0.5f}), {10, 10, 10}, 0.3f);
  const auto paint = built.add_material({0.7f, 0.7f, 0.7f}, {}, true);
  built.add_polygon({{0.8f, 0.5f, 0.7f}, {2.0f, 0.5f, 1.3f}, {2.0f, 1.4f, 1.3f}, {0.8f, 1.4f, 0.7f}}, paint);
  return built;
}

SceneBuilder coloured_blocks() {
  std::array<Rgb, 6> walls = all_walls({0.75f, 0.7f, 0.65f});
  walls[0] = {0.7f, 0.1f, 0.05f};
  walls[1] = {0.1f, 0.5f, 0.1f};
  SceneBuilder built = lit_room(1, walls, {12, 9, 5}, 0.3f);
  const auto blue = built.add_material({0.1f, 0.2f, 0.8f}), white = built.add_material({0.8f, 0.8f, 0.8f});
  built.add_box({0.5f, 0.9f, 0.3f}, {1.1f, 1.5f, 1.1f}, false, blue);
  const auto turned = built.add_object({{{0, 0, turned_and_moved(0.4, 2.1, 0.8, 0.7)}}});
  built.add_box({-0.35f, -0.3f, -0.3f}, {0.35f, 0.3f, 0.3f}, false, white, turned);
  return built;
}

}  // namespace tests
