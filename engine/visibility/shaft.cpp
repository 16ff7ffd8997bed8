#include "engine/visibility/shaft.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

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

/// Two unit vectors across `axis` and each other; any two where it has no length.
std::array<Vec3, 2> across(Vec3 axis) {
  const Vec3 aside = std::abs(axis.x) < std::abs(axis.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 s = cross(axis, aside);
  const float size = length(s);
  if (!(size > 0)) return {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  const Vec3 unit = (1.0f / size) * s;
  return {unit, normalized(cross(axis, unit))};
}

/// Sixteen planes side by side.
struct Planes {
  const float *x, *y, *z, *height;
};
struct TiltedPlanes {
  float *x, *y, *z, *height;
};

/// Tilts eight planes so that each touches both ends, the first four corners and the others.
KEYLUME_WIDEST
void tilt(const std::array<Vec3, 8>& ends, Vec3 axis, float per_square, float off, TiltedPlanes planes) {
  constexpr std::size_t kCount = 8;
  std::array<float, kCount> x, y, z, here, there;
  for (std::size_t k = 0; k < kCount; ++k) {
    x[k] = planes.x[k], y[k] = planes.y[k], z[k] = planes.z[k];
    here[k] = there[k] = -std::numeric_limits<float>::infinity();
  }
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < kCount; ++k) {
      here[k] = std::max(here[k], x[k] * ends[c].x + y[k] * ends[c].y + z[k] * ends[c].z);
      there[k] = std::max(there[k], x[k] * ends[4 + c].x + y[k] * ends[4 + c].y + z[k] * ends[4 + c].z);
    }
  std::array<float, kCount> most;
  for (std::size_t k = 0; k < kCount; ++k) {
    const float lean = (there[k] - here[k]) * per_square;
    x[k] -= lean * axis.x;
    y[k] -= lean * axis.y;
    z[k] -= lean * axis.z;
    most[k] = -std::numeric_limits<float>::infinity();
  }
  for (std::size_t c = 0; c < 8; ++c)
    for (std::size_t k = 0; k < kCount; ++k)
      most[k] = std::max(most[k], x[k] * ends[c].x + y[k] * ends[c].y + z[k] * ends[c].z);
  for (std::size_t k = 0; k < kCount; ++k) {
    planes.x[k] = x[k], planes.y[k] = y[k], planes.z[k] = z[k];
    planes.height[k] = most[k] + off * std::sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]);
  }
}

/// Is all of the box beyond one of the planes?
KEYLUME_WIDEST
bool any_beyond(Planes planes, Vec3 lower, Vec3 upper) {
  std::uint32_t beyond = 0;
  for (std::size_t k = 0; k < 16; ++k) {
    const float nearest = std::min(planes.x[k] * lower.x, planes.x[k] * upper.x) +
                          std::min(planes.y[k] * lower.y, planes.y[k] * upper.y) +
                          std::min(planes.z[k] * lower.z, planes.z[k] * upper.z);
    beyond |= nearest > planes.height[k] ? 1u : 0u;
  }
  return beyond != 0;
}

}  // namespace

Shaft::Shaft(const ShaftEnd& from, const ShaftEnd& to)
    : middle_(middle_of(from)),
      slack_m_(kTouching * std::min(from.slack_m, to.slack_m)),
      off_m_(std::max(from.slack_m, to.slack_m)) {
  for (std::uint32_t c = 0; c < 4; ++c) {
    ends_[c] = from.corners[std::min(c, from.count - 1)] - middle_;
    ends_[4 + c] = to.corners[std::min(c, to.count - 1)] - middle_;
  }
  height_.fill(std::numeric_limits<float>::infinity());
  tilt_planes(middle_of(to) - middle_, off_m_);
  set_plane(kAround, -from.normal, -dot(from.normal, ends_[0]) - kTouching * from.slack_m);
  set_plane(kAround + 1, -to.normal, -dot(to.normal, ends_[4]) - kTouching * to.slack_m);
}

/// The eight planes about the axis, which clear both ends by `off`.
void Shaft::tilt_planes(Vec3 axis, float off) {
  constexpr float kDiagonal = 0.70710678f;
  const auto [s, t] = across(axis);
  const Vec3 directions[kAround] = {s,  kDiagonal * (s + t),  t,  kDiagonal * (t - s),
                                    -s, kDiagonal * (-s - t), -t, kDiagonal * (s - t)};
  for (std::size_t k = 0; k < kAround; ++k) {
    nx_[k] = directions[k].x;
    ny_[k] = directions[k].y;
    nz_[k] = directions[k].z;
  }
  const float squared = dot(axis, axis);
  tilt(ends_, axis, squared > 0 ? 1.0f / squared : 0.0f, off,
       {nx_.data(), ny_.data(), nz_.data(), height_.data()});
}

void Shaft::set_plane(std::size_t k, Vec3 normal, float height) {
  nx_[k] = normal.x;
  ny_[k] = normal.y;
  nz_[k] = normal.z;
  height_[k] = normal == Vec3{} ? std::numeric_limits<float>::infinity() : height;
}

bool Shaft::may_meet(const Box& box) const {
  return !any_beyond({nx_.data(), ny_.data(), nz_.data(), height_.data()}, box.lower - middle_,
                     box.upper - middle_);
}

Box Shaft::box_of_end() const {
  const Box box = box_of(std::span(ends_).subspan(4));
  const Vec3 off{off_m_, off_m_, off_m_};
  return {box.lower + middle_ - off, box.upper + middle_ + off};
}

KEYLUME_WIDEST
std::uint32_t Shaft::may_meet(const FacetLanes& facets, std::uint32_t& entered) const {
  constexpr std::size_t kFacetLanes = FacetLanes::kCount;
  std::array<std::array<float, kFacetLanes>, 4> x, y, z;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < kFacetLanes; ++k) {
      x[c][k] = facets.x[c][k] - middle_.x;
      y[c][k] = facets.y[c][k] - middle_.y;
      z[c][k] = facets.z[c][k] - middle_.z;
    }
  std::array<std::array<float, kFacetLanes>, 2> lowest, highest;  // of either end over the plane of the facet
  for (std::size_t e = 0; e < 2; ++e) {
    lowest[e].fill(std::numeric_limits<float>::infinity());
    highest[e].fill(-std::numeric_limits<float>::infinity());
    for (std::size_t c = 4 * e; c < 4 * e + 4; ++c)
      for (std::size_t k = 0; k < kFacetLanes; ++k) {
        const float height = facets.nx[k] * (ends_[c].x - x[0][k]) + facets.ny[k] * (ends_[c].y - y[0][k]) +
                             facets.nz[k] * (ends_[c].z - z[0][k]);
        lowest[e][k] = std::min(lowest[e][k], height);
        highest[e][k] = std::max(highest[e][k], height);
      }
  }
  std::array<std::uint32_t, kFacetLanes> outside;
  for (std::size_t k = 0; k < kFacetLanes; ++k)
    outside[k] = (std::min(lowest[0][k], lowest[1][k]) >= -slack_m_ ? 1u : 0u) |
                 (std::max(highest[0][k], highest[1][k]) <= slack_m_ ? 1u : 0u);
  for (std::size_t p = 0; p < kPlanes; ++p)
    for (std::size_t k = 0; k < kFacetLanes; ++k) {
      const auto along = [&](std::size_t c) {
        return nx_[p] * x[c][k] + ny_[p] * y[c][k] + nz_[p] * z[c][k];
      };
      const float nearest = std::min(std::min(along(0), along(1)), std::min(along(2), along(3)));
      outside[k] |= nearest > height_[p] ? 1u : 0u;
    }
  std::uint32_t inside = 0, from_front = 0;
  for (std::uint32_t k = 0; k < kFacetLanes; ++k) inside |= (1u - outside[k]) << k;
  for (std::uint32_t k = 0; k < kFacetLanes; ++k)
    from_front |= ((lowest[0][k] > off_m_ ? 1u : 0u) & (highest[1][k] < -off_m_ ? 1u : 0u)) << k;
  entered = from_front;
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
