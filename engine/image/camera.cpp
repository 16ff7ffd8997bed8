#include "engine/image/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace engine {
namespace {

/// Some unit vector across `direction` (unit): away from the axis that it is closest to.
Vec3 any_across(Vec3 direction) {
  const Vec3 axis = std::abs(direction.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return normalized(cross(direction, axis));
}

std::uint32_t clamped_pixel(float coordinate, std::uint32_t size) {
  return static_cast<std::uint32_t>(std::clamp(coordinate, 0.0f, static_cast<float>(size)));
}

}  // namespace

Ray PinholeCamera::ray_through(float x, float y) const {
  const float across = 2 * x / static_cast<float>(width) - 1;
  const float up = 1 - 2 * y / static_cast<float>(height);
  Ray ray;
  ray.origin = position;
  ray.direction = forward + across * right + up * upward;
  return ray;
}

bool PinholeCamera::project(Vec3 point_m, float& x, float& y) const {
  const Vec3 offset = point_m - position;
  const float depth = dot(offset, forward);
  if (depth <= 1e-6f * length(offset)) return false;
  const float across = dot(offset, right) / (dot(right, right) * depth);
  const float up = dot(offset, upward) / (dot(upward, upward) * depth);
  x = 0.5f * static_cast<float>(width) * (1 + across);
  y = 0.5f * static_cast<float>(height) * (1 - up);
  return true;
}

PinholeCamera pinhole_camera(const CameraPose& pose, std::uint32_t width, std::uint32_t height) {
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.position = pose.position;
  camera.forward = normalized(pose.target - pose.position);
  const Vec3 across = cross(camera.forward, pose.up);
  const Vec3 right = length(across) > 1e-4f ? normalized(across) : any_across(camera.forward);
  const auto half_height = static_cast<float>(std::tan(pose.vertical_fov_degrees * std::numbers::pi / 360.0));
  camera.upward = half_height * cross(right, camera.forward);
  camera.right = (half_height * static_cast<float>(width) / static_cast<float>(height)) * right;
  return camera;
}

std::vector<SubPixel> sub_pixels(std::uint32_t count) {
  const auto height = [](std::uint32_t i) {
    const double y = 0.5 + i / std::numbers::phi;
    return y - std::floor(y);
  };
  std::vector<SubPixel> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t rank = 0;
    for (std::uint32_t k = 0; k < count; ++k) rank += height(k) < height(i);
    const auto n = static_cast<float>(count);
    points.push_back({(static_cast<float>(i) + 0.5f) / n, (static_cast<float>(rank) + 0.5f) / n});
  }
  return points;
}

PixelRect pixels_around(const PinholeCamera& camera, std::span<const Vec3> points_m) {
  float x_min = 1e30f, y_min = 1e30f, x_max = -1e30f, y_max = -1e30f;
  for (const Vec3 point : points_m) {
    float x, y;
    if (!camera.project(point, x, y)) return {0, 0, camera.width, camera.height};
    x_min = std::min(x_min, x);
    x_max = std::max(x_max, x);
    y_min = std::min(y_min, y);
    y_max = std::max(y_max, y);
  }
  const PixelRect rect{
      clamped_pixel(std::floor(x_min) - 1, camera.width), clamped_pixel(std::floor(y_min) - 1, camera.height),
      clamped_pixel(std::ceil(x_max) + 1, camera.width), clamped_pixel(std::ceil(y_max) + 1, camera.height)};
  return rect.x0 < rect.x1 && rect.y0 < rect.y1 ? rect : PixelRect{};
}

}  // namespace engine
