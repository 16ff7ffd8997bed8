#include "engine/visibility/shaft.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/widest.h"

namespace engine {
namespace {

/// Of the slack: what is closer to an end touches it.
constexpr float kTouching = 0.5f;

Vec3 middle_of(const ShaftEnd& end) {
  Vec3 sum;
  for (std::uint32_t c = 0; c < end.count; ++c) sum = sum + end.corners[c];
  return (1.0f / static_cast<float>(end.count)) * sum;
}

float farthest(std::span<const Vec3> points, Vec3 direction) {
  float most = dot(points[0], direction);
  for (const Vec3 point : points.subspan(1)) most = std::max(most, dot(point, direction));
  return most;
}

/// Two unit vectors across `axis` and each other; any two where it has no length.
std::array<Vec3, 2> across(Vec3 axis) {
  const Vec3 aside = std::abs(axis.x) < std::abs(axis.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 s = cross(axis, aside);
  const float size = length(s);
  if (!(size > 0)) return {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  const Vec3 unit = (1.0f / size) * s;
  return {unit, normalized(cross(axis, unit))};
}

}  // namespace

Shaft::Shaft(const ShaftEnd& from, const ShaftEnd& to)
    : middle_(middle_of(from)), slack_m_(kTouching * std::min(from.slack_m, to.slack_m)) {
  for (std::uint32_t c = 0; c < 4; ++c) {
    ends_[c] = from.corners[std::min(c, from.count - 1)] - middle_;
    ends_[4 + c] = to.corners[std::min(c, to.count - 1)] - middle_;
  }
  const std::span<const Vec3> all(ends_), here = all.first(4), there = all.subspan(4);
  const Vec3 axis = middle_of(to) - middle_;
  const float squared = dot(axis, axis);
  const auto [s, t] = across(axis);
  const float off = std::max(from.slack_m, to.slack_m);
  constexpr float kDiagonal = 0.70710678f;
  const Vec3 directions[kAround] = {s,  kDiagonal * (s + t),  t,  kDiagonal * (t - s),
                                    -s, kDiagonal * (-s - t), -t, kDiagonal * (s - t)};
  for (std::size_t k = 0; k < kAround; ++k) {
    Vec3 normal = directions[k];
    if (squared > 0) {
      const float wider = farthest(there, normal) - farthest(here, normal);
      normal = normal - (wider / squared) * axis;
    }
    set_plane(k, normal, farthest(all, normal) + off * length(normal));
  }
  set_plane(kAround, -from.normal, -dot(from.normal, ends_[0]) - kTouching * from.slack_m);
  set_plane(kAround + 1, -to.normal, -dot(to.normal, ends_[4]) - kTouching * to.slack_m);
}

void Shaft::set_plane(std::size_t k, Vec3 normal, float height) {
  nx_[k] = normal.x;
  ny_[k] = normal.y;
  nz_[k] = normal.z;
  height_[k] = normal == Vec3{} ? std::numeric_limits<float>::infinity() : height;
}

bool Shaft::may_meet(const Box& box) const {
  const Vec3 lower = box.lower - middle_, upper = box.upper - middle_;
  bool outside = false;
  for (std::size_t k = 0; k < kPlanes; ++k) {
    const float nearest = std::min(nx_[k] * lower.x, nx_[k] * upper.x) +
                          std::min(ny_[k] * lower.y, ny_[k] * upper.y) +
                          std::min(nz_[k] * lower.z, nz_[k] * upper.z);
    outside |= nearest > height_[k];
  }
  return !outside;
}

KEYLUME_WIDEST
std::uint32_t Shaft::may_meet(const FacetLanes& facets) const {
  constexpr std::size_t kLanes = FacetLanes::kCount;
  std::array<std::array<float, kLanes>, 4> x, y, z;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < kLanes; ++k) {
      x[c][k] = facets.x[c][k] - middle_.x;
      y[c][k] = facets.y[c][k] - middle_.y;
      z[c][k] = facets.z[c][k] - middle_.z;
    }
  std::array<float, kLanes> lowest, highest;  // of the ends over the plane of the facet
  lowest.fill(std::numeric_limits<float>::infinity());
  highest.fill(-std::numeric_limits<float>::infinity());
  for (const Vec3 end : ends_)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float height = facets.nx[k] * (end.x - x[0][k]) + facets.ny[k] * (end.y - y[0][k]) +
                           facets.nz[k] * (end.z - z[0][k]);
      lowest[k] = std::min(lowest[k], height);
      highest[k] = std::max(highest[k], height);
    }
  std::array<std::uint32_t, kLanes> outside;
  for (std::size_t k = 0; k < kLanes; ++k)
    outside[k] = (lowest[k] >= -slack_m_ ? 1u : 0u) | (highest[k] <= slack_m_ ? 1u : 0u);
  for (std::size_t p = 0; p < kPlanes; ++p)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const auto along = [&](std::size_t c) {
        return nx_[p] * x[c][k] + ny_[p] * y[c][k] + nz_[p] * z[c][k];
      };
      const float nearest = std::min(std::min(along(0), along(1)), std::min(along(2), along(3)));
      outside[k] |= nearest > height_[p] ? 1u : 0u;
    }
  std::uint32_t inside = 0;
  for (std::uint32_t k = 0; k < kLanes; ++k) inside |= (1u - outside[k]) << k;
  return inside;
}

void FacetLanes::set(std::size_t k, std::span<const Vec3, 4> corners, Vec3 normal) {
  for (std::size_t c = 0; c < 4; ++c) {
    x[c][k] = corners[c].x;
    y[c][k] = corners[c].y;
    z[c][k] = corners[c].z;
  }
  nx[k] = normal.x;
  ny[k] = normal.y;
  nz[k] = normal.z;
}

}  // namespace engine
