#include "engine/direct/form_factor.h"

#include <array>
#include <cmath>
#include <numbers>

namespace engine {
namespace {

constexpr std::size_t kCornersMax = 9;  // clipping a convex octagon by a plane adds one corner

struct ClippedPolygon {
  std::array<Vec3, kCornersMax> r;
  std::size_t count = 0;
  void add(Vec3 v) {
    if (count < kCornersMax) r[count++] = v;
  }
};

/// The part of the polygon above the horizon, as vectors from the point (Sutherland & Hodgman).
ClippedPolygon above_horizon(Vec3 point, Vec3 normal, std::span<const Vec3> corners) {
  ClippedPolygon clipped;
  Vec3 previous = corners.back() - point;
  float previous_height = dot(previous, normal);
  for (const Vec3 corner : corners) {
    const Vec3 current = corner - point;
    const float height = dot(current, normal);
    if ((height > 0) != (previous_height > 0)) {
      const float t = previous_height / (previous_height - height);
      clipped.add(previous + t * (current - previous));
    }
    if (height > 0) clipped.add(current);
    previous = current;
    previous_height = height;
  }
  return clipped;
}

}  // namespace

float point_to_polygon_form_factor(Vec3 point, Vec3 normal, std::span<const Vec3> corners) {
  const ClippedPolygon polygon = above_horizon(point, normal, corners);
  if (polygon.count < 3) return 0;
  float sum = 0;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Vec3 a = polygon.r[k], b = polygon.r[(k + 1) % polygon.count];
    const Vec3 perpendicular = cross(a, b);
    const float sine = length(perpendicular);
    if (sine == 0) continue;  // the point lies on the edge's line
    sum += std::atan2(sine, dot(a, b)) / sine * dot(normal, perpendicular);
  }
  return std::min(1.0f, std::abs(sum) * (0.5f / std::numbers::pi_v<float>));
}

}  // namespace engine
