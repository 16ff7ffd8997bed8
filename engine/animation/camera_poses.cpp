#include "engine/animation/camera_poses.h"

#include <algorithm>

#include "engine/animation/tracks.h"

namespace engine {
namespace {

constexpr double kDefaultFovDegrees = 50;
constexpr float kAlongUpSine = 1.75e-3f;  // sin 0.1 degrees

Vec3 metres(const api::Vec3& units, double metres_per_unit) {
  const auto scaled = [&](int i) { return static_cast<float>(units[i] * metres_per_unit); };
  return {scaled(0), scaled(1), scaled(2)};
}

}  // namespace

std::vector<CameraPose> poses_of(const api::Camera& camera, api::UpAxis up, double metres_per_unit,
                                 FrameIndex frame_count) {
  const bool y_up = up == api::UpAxis::y;
  const Vec3 up_axis = y_up ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 ahead = y_up ? Vec3{0, 0, -1} : Vec3{0, 1, 0};
  Vec3 direction = ahead;
  std::vector<CameraPose> poses;
  poses.reserve(frame_count);
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    CameraPose pose;
    pose.position = metres(value_at(camera.position, frame, api::Vec3{0, 0, 0}), metres_per_unit);
    pose.target = metres(value_at(camera.target, frame, api::Vec3{0, 0, 0}), metres_per_unit);
    pose.vertical_fov_degrees =
        std::clamp(value_at(camera.vertical_fov_degrees, frame, kDefaultFovDegrees), 1.0, 170.0);
    const Vec3 view = pose.target - pose.position;
    const float distance = length(view);
    // Nearer than the coordinates' last digits, the direction is rounding noise.
    const float noise = 1e-6f * std::max(length(pose.target), length(pose.position));
    if (distance > noise)
      direction = view * (1.0f / distance);
    else
      pose.target = pose.position + direction * std::max(1.0f, length(pose.position));
    pose.up = length(cross(direction, up_axis)) < kAlongUpSine ? ahead : up_axis;
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace engine
