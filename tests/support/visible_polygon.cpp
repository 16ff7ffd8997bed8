#include "tests/support/visible_polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tests {
namespace {

/// Distances below this are none: scenes are a few metres large, doubles have sixteen digits.
constexpr double kTiny_m = 1e-9;

double distance(const Point& n, const Point& p, double d) {
  return dot(n, p) - d;
}

Point unit(const Point& a) {
  return (1 / std::sqrt(dot(a, a))) * a;
}

}  // namespace

Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Point operator-(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point operator*(double s, const Point& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

PointPolygon clipped(const PointPolygon& polygon, const Point& n, double d) {
  PointPolygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double at_a = distance(n, a, d), at_b = distance(n, b, d);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))
      kept.push_back(a + (at_a / (at_a - at_b)) * (b - a));
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

Shadow::Shadow(const PointPolygon& polygon) {
  Point middle{};
  for (const Point& corner : polygon) middle = middle + (1.0 / static_cast<double>(polygon.size())) * corner;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point side = unit(cross(polygon[k], polygon[(k + 1) % polygon.size()]));
    planes_.push_back({dot(side, middle) < 0 ? -1.0 * side : side, 0});
  }
  const Point face = unit(cross(polygon[1] - polygon[0], polygon[2] - polygon[0]));
  const double offset = dot(face, polygon[0]);
  planes_.push_back({offset < 0 ? -1.0 * face : face, std::abs(offset) + kTiny_m});
}

void Shadow::subtract_from(std::vector<PointPolygon>& pieces) const {
  std::vector<PointPolygon> seen;
  for (PointPolygon& piece : pieces) {
    const bool apart = std::any_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
      return std::all_of(piece.begin(), piece.end(), [&](const Point& corner) {
        return distance(plane.normal, corner, plane.offset) <= kTiny_m;
      });
    });
    if (apart) {
      seen.push_back(std::move(piece));
      continue;
    }
    for (const Plane& plane : planes_) {
      if (piece.empty()) break;
      PointPolygon outside = clipped(piece, -1.0 * plane.normal, -plane.offset);
      if (!outside.empty()) seen.push_back(std::move(outside));
      piece = clipped(piece, plane.normal, plane.offset);
    }
  }
  pieces = std::move(seen);
}

double lambert(const PointPolygon& polygon, const Point& n) {
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const Point across = cross(a, b);
    const double length = std::sqrt(dot(across, across));
    if (length > 0) sum += std::atan2(length, dot(a, b)) * dot(n, across) / length;
  }
  return std::abs(sum) / (2 * std::numbers::pi);
}

}  // namespace tests
