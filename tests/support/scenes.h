// Scenes built by hand, in memory, for tests: no files, no parser.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/scene/scene.h"

namespace tests {

/// A scene and what moves in it. Object 0 rests; every call that adds something answers its index.
class SceneBuilder {
 public:
  explicit SceneBuilder(engine::FrameIndex frame_count = 1) {
    animation_.frame_count = frame_count;
    add_object();
  }

  std::uint32_t add_material(engine::Rgb reflectance, engine::Rgb exitance_w_m2 = {},
                             bool both_sides = false) {
    scene_.materials.push_back({"", reflectance, exitance_w_m2, both_sides});
    animation_.emission.exitance_w_m2.push_back({exitance_w_m2});
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
  }

  /// A material whose exitance is another in every frame.
  std::uint32_t add_material(engine::Rgb reflectance, std::vector<engine::Rgb> exitance_w_m2) {
    const std::uint32_t material = add_material(reflectance, exitance_w_m2.front());
    animation_.emission.exitance_w_m2[material] = std::move(exitance_w_m2);
    return material;
  }

  /// An object that rests in every frame.
  std::uint32_t add_object() { return add_object({{{0, animation_.frame_count - 1, {}}}}); }

  std::uint32_t add_object(engine::ObjectMotion motion) {
    scene_.objects.push_back({});
    animation_.objects.push_back(std::move(motion));
    return static_cast<std::uint32_t>(scene_.objects.size() - 1);
  }

  /// Corners counter-clockwise seen from the front.
  void add_polygon(const std::vector<engine::Vec3>& corners, std::uint32_t material,
                   std::uint32_t object = 0) {
    scene_.polygons.push_back({static_cast<std::uint32_t>(scene_.corners.size()),
                               static_cast<std::uint32_t>(corners.size()), object, material, 1});
    for (const engine::Vec3 corner : corners) {
      scene_.corners.push_back(static_cast<std::uint32_t>(scene_.vertices.size()));
      scene_.vertices.push_back(corner);
    }
  }

  /// Six faces in the order -x, +x, -y, +y, -z, +z, with fronts inside (a room) or outside (a thing), one
  /// material each.
  void add_box(engine::Vec3 low, engine::Vec3 high, bool inward,
               const std::array<std::uint32_t, 6>& materials, std::uint32_t object = 0) {
    const auto corner = [&](int c) {
      return engine::Vec3{c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z};
    };
    constexpr std::array<std::array<int, 4>, 6> kOutward{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (std::size_t face = 0; face < 6; ++face) {
      const auto& [a, b, c, d] = kOutward[face];
      if (inward)
        add_polygon({corner(d), corner(c), corner(b), corner(a)}, materials[face], object);
      else
        add_polygon({corner(a), corner(b), corner(c), corner(d)}, materials[face], object);
    }
  }
  void add_box(engine::Vec3 low, engine::Vec3 high, bool inward, std::uint32_t material,
               std::uint32_t object = 0) {
    add_box(low, high, inward, {material, material, material, material, material, material}, object);
  }

  void add_camera(const std::string& name, std::vector<engine::CameraPose> poses) {
    animation_.cameras[name] = std::move(poses);
  }

  const engine::Scene& scene() const { return scene_; }
  const engine::Animation& animation() const { return animation_; }

 private:
  engine::Scene scene_;
  engine::Animation animation_;
};

/// One pose for every frame, equal neighbours in one span; `pose_at(t)` with t from 0 (first frame) to 1
/// (last).
template <class PoseAt>
engine::ObjectMotion motion(engine::FrameIndex frame_count, const PoseAt& pose_at) {
  engine::ObjectMotion motion;
  for (engine::FrameIndex f = 0; f < frame_count; ++f) {
    const engine::Pose pose = pose_at(frame_count > 1 ? double(f) / (frame_count - 1) : 0.0);
    if (!motion.spans.empty() && motion.spans.back().pose == pose)
      motion.spans.back().last = f;
    else
      motion.spans.push_back({f, f, pose});
  }
  return motion;
}

/// Turned by `angle` [radians] about the vertical (z), then moved to (x, y, z).
inline engine::Pose turned_and_moved(double angle, double x, double y, double z) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{{c, -s, 0, x}, {s, c, 0, y}, {0, 0, 1, z}}}};
}

}  // namespace tests
