#include "engine/direct/form_factor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/widest.h"

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

/// The part of the polygon above the horizon, as vectors from the point (Sutherland & Hodgman). A convex
/// polygon crosses it twice at most. Where it seems to cross it more often it lies in the horizon's plane,
/// its corners above and below by rounding alone: nothing of it is seen.
ClippedPolygon above_horizon(Vec3 point, Vec3 normal, std::span<const Vec3> corners) {
  ClippedPolygon clipped;
  int crossings = 0;
  Vec3 previous = corners.back() - point;
  float previous_height = dot(previous, normal);
  for (const Vec3 corner : corners) {
    const Vec3 current = corner - point;
    const float height = dot(current, normal);
    if ((height > 0) != (previous_height > 0)) {
      const float t = previous_height / (previous_height - height);
      clipped.add(previous + t * (current - previous));
      ++crossings;
    }
    if (height > 0) clipped.add(current);
    previous = current;
    previous_height = height;
  }
  if (crossings > 2) clipped.count = 0;
  return clipped;
}

constexpr std::size_t kLanes = 16;
using Lanes = std::array<float, kLanes>;

/// arccos(c) / sqrt(1 - c^2) for 0 <= c <= 1, to 2.4e-7: the Chebyshev expansion of degree 8.
inline float angle_over_sine(float c) {
  constexpr float kCoefficients[] = {0.0176536679f, -0.0979687042f, 0.253238477f, -0.424566187f, 0.557022056f,
                                     -0.661089453f, 0.784896256f,   -0.99998226f, 1.57079622f};
  float value = kCoefficients[0];
  for (std::size_t k = 1; k < std::size(kCoefficients); ++k) value = value * c + kCoefficients[k];
  return value;
}

/// Lambert's formula for 16 points, whose horizon the polygon is above; 0 behind `front`. Vectors to the
/// corners are kept as unit vectors, one array per coordinate; no branch depends on a lane.
KEYLUME_WIDEST
void lambert_sum(std::span<const Vec3> corners, Vec3 normal, Vec3 front, const Lanes& x, const Lanes& y,
                 const Lanes& z, Lanes& factors) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const std::size_t count = corners.size();
  std::array<Lanes, 6> rx, ry, rz;
  for (std::size_t c = 0; c <= count; ++c)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Vec3 corner = corners[c == count ? 0 : c];
      const float dx = corner.x - x[k], dy = corner.y - y[k], dz = corner.z - z[k];
      const float scale = 1.0f / std::sqrt(std::max(1e-30f, dx * dx + dy * dy + dz * dz));
      rx[c][k] = dx * scale;
      ry[c][k] = dy * scale;
      rz[c][k] = dz * scale;
    }
  Lanes sum{};
  for (std::size_t c = 0; c < count; ++c)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float ax = rx[c][k], ay = ry[c][k], az = rz[c][k];
      const float bx = rx[c + 1][k], by = ry[c + 1][k], bz = rz[c + 1][k];
      const float cx = ay * bz - az * by, cy = az * bx - ax * bz, cz = ax * by - ay * bx;
      const float cosine = ax * bx + ay * by + az * bz;
      const float sine = std::sqrt(std::max(1e-30f, cx * cx + cy * cy + cz * cz));
      const float acute = angle_over_sine(std::min(1.0f, std::abs(cosine)));
      const float obtuse = kPi / sine - acute;  // of the cosine's root it would be off where it is near -1
      sum[k] += (normal.x * cx + normal.y * cy + normal.z * cz) * (cosine < 0.0f ? obtuse : acute);
    }
  const Vec3 corner = corners[0];
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float before =
        front.x * (x[k] - corner.x) + front.y * (y[k] - corner.y) + front.z * (z[k] - corner.z);
    const float factor = std::min(1.0f, std::abs(sum[k]) * (0.5f / kPi));
    factors[k] = before > 0.0f ? factor : 0.0f;
  }
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

PolygonOverPlane::PolygonOverPlane(Vec3 origin, Vec3 normal, std::span<const Vec3> corners,
                                   Vec3 polygon_normal)
    : normal_(normal), front_(polygon_normal) {
  const ClippedPolygon clipped = above_horizon(origin, normal, corners);
  if (clipped.count < 3) return;
  count_ = static_cast<std::uint32_t>(clipped.count);
  for (std::uint32_t c = 0; c < count_; ++c) corners_[c] = clipped.r[c] + origin;
}

void PolygonOverPlane::form_factors(const PointArrays& points, float* factors) const {
  std::fill_n(factors, points.count, 0.0f);
  if (count_ == 0) return;
  for (std::size_t first = 0; first < points.count; first += kLanes) {
    const std::size_t count = std::min(kLanes, points.count - first);
    Lanes x, y, z, sum;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const std::size_t from = first + std::min(k, count - 1);
      x[k] = points.x[from];
      y[k] = points.y[from];
      z[k] = points.z[from];
    }
    lambert_sum({corners_.data(), count_}, normal_, front_, x, y, z, sum);
    std::copy_n(sum.begin(), count, factors + first);
  }
}

}  // namespace engine
