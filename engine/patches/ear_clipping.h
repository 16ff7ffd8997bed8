// Triangulation of simple polygons.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/vec3.h"

namespace engine {

/// Splits a simple polygon (convex or concave, nearly planar) of n corners into n - 2 triangles of corner
/// numbers, each turning the same way as the polygon. Where no ear is left (a polygon that crosses itself)
/// the rest is fanned. Source: Meisters, "Polygons have ears", 1975.
std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Vec3> corners);

/// The same for many polygons, one after the other, in the same memory.
class EarClipping {
 public:
  /// Valid until the next call.
  std::span<const std::array<std::uint32_t, 3>> clip(std::span<const Vec3> corners);

 private:
  std::vector<std::uint32_t> ring_;  ///< the corners that are left
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

/// Area vector of a closed polygon: its length is the area, its direction the normal (Newell).
Vec3 area_vector(std::span<const Vec3> corners);

}  // namespace engine
