#include "engine/scene/clean_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace engine {
namespace {

constexpr double kAreaOfEdgeSquare = 1e-7;
constexpr double kExtentOfEdgeMax = 1e6;

struct Size {
  double area = 0, longest_edge = 0, shortest_edge = std::numeric_limits<double>::infinity();
};

/// Newell's formula about the first corner, so that a small polygon far from the origin keeps its digits.
Size size_of(const Scene& scene, const std::uint32_t* corners, std::uint32_t count) {
  using Point = std::array<double, 3>;
  const Vec3 origin = scene.vertices[corners[0]];
  const auto point = [&](std::uint32_t i) -> Point {
    const Vec3 p = scene.vertices[corners[i]];
    return {double{p.x} - origin.x, double{p.y} - origin.y, double{p.z} - origin.z};
  };
  double longest = 0, shortest = std::numeric_limits<double>::infinity();
  Point normal{};
  Point a = point(0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Point b = point(i + 1 < count ? i + 1 : 0);
    normal[0] += a[1] * b[2] - a[2] * b[1];
    normal[1] += a[2] * b[0] - a[0] * b[2];
    normal[2] += a[0] * b[1] - a[1] * b[0];
    const double squared =
        (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) + (b[2] - a[2]) * (b[2] - a[2]);
    longest = std::max(longest, squared);
    shortest = std::min(shortest, squared);
    a = b;
  }
  const double area = 0.5 * std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  return {area, std::sqrt(longest), std::sqrt(shortest)};
}

void move_corner(Scene& scene, std::uint32_t from, std::uint32_t to) {
  for (auto* of_corner : {&scene.corners, &scene.corner_uvs, &scene.corner_normals})
    if (!of_corner->empty()) (*of_corner)[to] = (*of_corner)[from];
}

/// Moves the corners of `polygon` to `to`, without those at the point of the one before.
std::uint32_t move_corners(Scene& scene, const Polygon& polygon, std::uint32_t to) {
  std::uint32_t count = 0;
  const auto at = [&](std::uint32_t corner) { return scene.vertices[scene.corners[corner]]; };
  for (std::uint32_t i = 0; i < polygon.corner_count; ++i) {
    const std::uint32_t corner = polygon.first_corner + i;
    if (count > 0 && at(corner) == at(to + count - 1)) continue;
    if (corner != to + count) move_corner(scene, corner, to + count);
    ++count;
  }
  while (count > 1 && at(to) == at(to + count - 1)) --count;
  return count;
}

void warn_about_precision(Scene& scene, double shortest_edge) {
  constexpr float kFar = std::numeric_limits<float>::max();
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const std::uint32_t corner : scene.corners) {
    low = min(low, scene.vertices[corner]);
    high = max(high, scene.vertices[corner]);
  }
  const double extent = length(high - low);
  if (extent <= kExtentOfEdgeMax * shortest_edge) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "scene.obj: %.3g m across with edges of %.3g m: beyond what single precision traces well",
                extent, shortest_edge);
  scene.warnings.emplace_back(text);
}

}  // namespace

void clean_polygons(Scene& scene) {
  std::size_t kept = 0, merged = 0, dropped = 0;
  std::uint32_t to = 0, first_dropped_line = 0;
  double shortest_edge = std::numeric_limits<double>::infinity();
  for (Polygon polygon : scene.polygons) {
    const std::uint32_t count = move_corners(scene, polygon, to);
    const Size size = count < 3 ? Size{} : size_of(scene, &scene.corners[to], count);
    if (count < 3 || size.area <= kAreaOfEdgeSquare * size.longest_edge * size.longest_edge) {
      if (dropped++ == 0) first_dropped_line = polygon.obj_line;
      continue;
    }
    merged += count < polygon.corner_count;
    shortest_edge = std::min(shortest_edge, size.shortest_edge);
    polygon.first_corner = to;
    polygon.corner_count = count;
    scene.polygons[kept++] = polygon;
    to += count;
  }
  scene.polygons.resize(kept);
  for (auto* of_corner : {&scene.corners, &scene.corner_uvs, &scene.corner_normals})
    if (!of_corner->empty()) of_corner->resize(to);
  if (dropped > 0)
    scene.warnings.push_back("scene.obj: " + std::to_string(dropped) +
                             " polygons without area dropped, the first in line " +
                             std::to_string(first_dropped_line));
  if (merged > 0)
    scene.warnings.push_back("scene.obj: " + std::to_string(merged) +
                             " polygons with repeated corners, counted once");
  if (kept > 0) warn_about_precision(scene, shortest_edge);
}

}  // namespace engine
