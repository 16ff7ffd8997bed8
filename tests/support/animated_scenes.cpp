#include "tests/support/animated_scenes.h"

#include <numbers>

namespace tests {
namespace {

using engine::FrameIndex;
using engine::Rgb;
using engine::Vec3;

constexpr FrameIndex kFrames = 40;
constexpr Rgb kLamp_w_m2{20, 18, 15};

/// Colours of the walls -x, +x, -y, +y, of the floor and of the ceiling.
struct Paints {
  std::array<std::uint32_t, 6> walls;
  std::uint32_t thing;
};

Paints add_room(SceneBuilder& built, Vec3 size) {
  const auto grey = built.add_material({0.5f, 0.5f, 0.5f}), warm = built.add_material({0.6f, 0.3f, 0.2f});
  const auto floor = built.add_material({0.4f, 0.35f, 0.3f}),
             white = built.add_material({0.75f, 0.75f, 0.75f});
  const Paints paints{{warm, grey, grey, grey, floor, white}, built.add_material({0.3f, 0.5f, 0.6f})};
  built.add_box({0, 0, 0}, size, true, paints.walls);
  return paints;
}

/// A square lamp that looks down from z, its middle at (x, y).
void add_lamp(SceneBuilder& built, float x, float y, float z, float edge, std::uint32_t material,
              std::uint32_t object = 0) {
  const float h = edge / 2;
  built.add_polygon({{x - h, y - h, z}, {x - h, y + h, z}, {x + h, y + h, z}, {x + h, y - h, z}}, material,
                    object);
}

void add_lamp(SceneBuilder& built, float x, float y, float z) {
  add_lamp(built, x, y, z, 0.8f, built.add_material({}, kLamp_w_m2));
}

/// A box about its own origin, on an object of its own.
void add_moving_box(SceneBuilder& built, Vec3 size, std::uint32_t paint, engine::ObjectMotion motion) {
  const auto object = built.add_object(std::move(motion));
  built.add_box(-0.5f * size, 0.5f * size, false, paint, object);
}

/// It crosses the room within a quarter of the time and rests before and after.
SceneBuilder fast_small_object() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  add_lamp(built, 3, 2, 2.4f);
  add_moving_box(built, {0.4f, 0.4f, 0.4f}, paints.thing, motion(kFrames, [](double t) {
                   const double s = std::clamp(4 * t - 1.5, 0.0, 1.0);
                   return turned_and_moved(3 * s, 0.6 + 4.8 * s, 1.2 + 1.4 * s, 0.9);
                 }));
  return built;
}

SceneBuilder slow_large_object() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  add_lamp(built, 2, 2, 2.4f);
  add_lamp(built, 4.5f, 1.5f, 2.4f);
  add_moving_box(built, {1.5f, 1.2f, 1.6f}, paints.thing,
                 motion(kFrames, [](double t) { return turned_and_moved(0.4 * t, 2 + 1.5 * t, 2, 0.95); }));
  return built;
}

/// One lamp burns; the other is switched on, off and on, and at last fades. A box glides by.
SceneBuilder blinking_light() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  add_lamp(built, 1.5f, 2, 2.4f);
  std::vector<Rgb> series;
  for (FrameIndex f = 0; f < kFrames; ++f) {
    const bool on = (f >= 7 && f < 9) || f == 14 || f >= 20;
    series.push_back((on ? f > 30 ? 1 - float(f - 30) / 12 : 1.0f : 0.0f) * kLamp_w_m2);
  }
  add_lamp(built, 4.5f, 2, 2.4f, 0.8f, built.add_material({}, series));
  add_moving_box(built, {0.8f, 0.8f, 0.8f}, paints.thing,
                 motion(kFrames, [](double t) { return turned_and_moved(0, 2 + 2 * t, 1 + 0.5 * t, 0.7); }));
  return built;
}

/// Two rooms; the lamp is in one of them, a door of .9 x 2 m between them opens by 95 degrees.
SceneBuilder opening_door() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  const auto paint = paints.walls[1];
  built.add_box({2.95f, 0, 0}, {3.05f, 1.5f, 2.5f}, false, paint);
  built.add_box({2.95f, 2.4f, 0}, {3.05f, 4, 2.5f}, false, paint);
  built.add_box({2.95f, 1.5f, 2}, {3.05f, 2.4f, 2.5f}, false, paint);
  add_lamp(built, 1.5f, 2, 2.4f);
  const auto door = built.add_object(motion(kFrames, [](double t) {
    const double s = std::clamp(1.6 * t - 0.3, 0.0, 1.0);
    return turned_and_moved(-95 * s * std::numbers::pi / 180, 3, 1.5, 0);
  }));
  built.add_box({-0.02f, 0.01f, 0.01f}, {0.02f, 0.89f, 1.99f}, false, paints.thing, door);
  return built;
}

/// A lamp under a small hood goes round between four columns; another one burns in a corner.
SceneBuilder light_carried_through_columns() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  for (const auto& [x, y] : {std::pair{1.5f, 1.2f}, {1.5f, 2.5f}, {4.2f, 1.2f}, {4.2f, 2.5f}})
    built.add_box({x, y, 0}, {x + 0.3f, y + 0.3f, 2.5f}, false, paints.thing);
  add_lamp(built, 5.4f, 3.4f, 2.4f, 0.5f, built.add_material({}, kLamp_w_m2));
  const auto carried = built.add_object(motion(kFrames, [](double t) {
    return turned_and_moved(0, 0.8 + 4.4 * t, 2 + 0.25 * std::sin(2 * std::numbers::pi * t), 1.6);
  }));
  built.add_box({-0.2f, -0.2f, 0.02f}, {0.2f, 0.2f, 0.1f}, false, paints.thing, carried);
  add_lamp(built, 0, 0, 0, 0.3f, built.add_material({}, {60, 50, 40}), carried);
  return built;
}

SceneBuilder two_objects_crossing() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  add_lamp(built, 3, 2, 2.4f);
  add_moving_box(built, {0.7f, 0.5f, 0.6f}, paints.thing,
                 motion(kFrames, [](double t) { return turned_and_moved(t, 0.8 + 4.4 * t, 1.4, 0.8); }));
  add_moving_box(built, {0.5f, 0.7f, 0.8f}, paints.walls[0],
                 motion(kFrames, [](double t) { return turned_and_moved(-t, 5.2 - 4.4 * t, 2.5, 1.1); }));
  return built;
}

SceneBuilder static_scene() {
  SceneBuilder built(kFrames);
  const Paints paints = add_room(built, {6, 4, 2.5f});
  add_lamp(built, 3, 2, 2.4f);
  built.add_box({1, 1, 0.1f}, {2, 2, 1.2f}, false, paints.thing);
  return built;
}

SceneBuilder camera_only() {
  SceneBuilder built = static_scene();
  std::vector<engine::CameraPose> poses;
  for (FrameIndex f = 0; f < kFrames; ++f)
    poses.push_back({{0.5f + 0.1f * float(f), 0.5f, 1.6f}, {3, 2, 1}, {0, 0, 1}, 60});
  built.add_camera("main", std::move(poses));
  return built;
}

}  // namespace

std::vector<AnimatedScene> animated_scenes() {
  return {{"fast small object", fast_small_object()},
          {"slow large object", slow_large_object()},
          {"blinking light", blinking_light()},
          {"opening door", opening_door()},
          {"light through columns", light_carried_through_columns()},
          {"two objects crossing", two_objects_crossing()},
          {"static scene", static_scene()},
          {"camera only", camera_only()}};
}

}  // namespace tests
