// Facets where their object puts them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"

namespace engine {

/// A facet in world space, in the slots [first_slot, last_slot] of a window of frames.
struct PlacedFacet {
  Vec3 origin, edge_u, edge_v;  ///< [m]
  /// As Facet's, each placed for itself: facets of one object that share a vertex share it here too, bit for
  /// bit, which keeps rays from slipping between them  [m]
  std::array<Vec3, 4> corners;
  Vec3 normal;  ///< unit, of the front; a mirroring pose keeps the front a front
  std::uint32_t facet = 0;
  std::uint32_t first_slot = 0, last_slot = 0;
};

PlacedFacet place(const Facet& facet, const Pose& pose);

/// In world space  [m]
inline Vec3 point_at(const PlacedFacet& placed, float u, float v) {
  return placed.origin + u * placed.edge_u + v * placed.edge_v;
}

/// A point (u, v) of a cell, uniform by area for a, b uniform in [0, 1).
std::pair<float, float> uv_in(const CellCorners& cell, float a, float b);

/// A point of a cell of it, uniform by area for a, b uniform in [0, 1)  [m]
Vec3 point_in(const PlacedFacet& placed, const CellCorners& cell, float a, float b);

/// The slots of a window in which an object holds one pose.
struct PlacedRange {
  const Pose* pose = nullptr;
  std::uint32_t first_slot = 0, last_slot = 0;
};

/// The poses that an object takes in the window `frames` (increasing), in order; slots without a range are
/// those in which it is not there.
std::vector<PlacedRange> placed_ranges(const ObjectMotion& motion, std::span<const FrameIndex> frames);

}  // namespace engine
