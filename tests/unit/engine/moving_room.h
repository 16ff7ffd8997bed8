// A closed room with closed things in it, one of which moves, one that comes and goes.
#pragma once

#include <cmath>

#include "tests/unit/engine/scenes.h"

namespace tests {

/// 3 x 2.5 x 2 m. Object 0: the room and a box on its floor. Object 1: a box that takes another place in
/// every frame. Object 2: a box that rests, but is there in frames 2, 3 and 7 only.
inline engine::Scene room_with_things(bool both_sides = false) {
  engine::Scene scene = scene_with(3, 1, both_sides);
  add_box(scene, {-1.5f, -1.25f, 0}, {1.5f, 1.25f, 2}, true);
  add_box(scene, {-1.0f, -0.9f, 0.05f}, {-0.4f, -0.3f, 0.8f}, false);
  add_box(scene, {-0.3f, -0.2f, -0.15f}, {0.3f, 0.2f, 0.15f}, false, 1);
  add_box(scene, {0.7f, 0.2f, 0.1f}, {1.1f, 0.9f, 0.6f}, false, 2);
  return scene;
}

inline engine::Animation things_move(const engine::Scene& scene, engine::FrameIndex frames) {
  engine::Animation animation = still(scene, frames);
  animation.objects[1].spans.clear();
  for (engine::FrameIndex f = 0; f < frames; ++f) {
    const double angle = 0.2 + 0.3 * f;
    engine::Pose pose = moved_to(0.8 * std::cos(angle), 0.5 * std::sin(angle), 1.2 + 0.05 * (f % 5));
    pose.m[0][0] = pose.m[1][1] = std::cos(2 * angle);
    pose.m[0][1] = -std::sin(2 * angle);
    pose.m[1][0] = std::sin(2 * angle);
    animation.objects[1].spans.push_back({f, f, pose});
  }
  animation.objects[2].spans.clear();
  if (frames > 3) animation.objects[2].spans.push_back({2, 3, {}});
  if (frames > 7) animation.objects[2].spans.push_back({7, 7, {}});
  return animation;
}

struct MovingRoom : World {
  explicit MovingRoom(engine::FrameIndex frames, double patch_edge_m = 0.5, bool both_sides = false)
      : World(room_with_things(both_sides), things_move(room_with_things(), frames), patch_edge_m) {}
};

}  // namespace tests
