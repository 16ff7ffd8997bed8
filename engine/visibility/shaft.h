// What may stand between two polygons.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/visibility/box_tree.h"

namespace engine {

/// An end of a shaft: a convex planar polygon of 3 or 4 corners, or a point (1).
struct ShaftEnd {
  std::array<Vec3, 4> corners;
  std::uint32_t count = 0;
  Vec3 normal;        ///< unit; rays meet the end from this side of its plane. Zero: from anywhere
  float slack_m = 0;  ///< how far off the polygon rays start and end
};

/// Sixteen facets side by side.
struct FacetLanes {
  static constexpr std::size_t kCount = 16;
  std::array<std::array<float, kCount>, 4> x{}, y{}, z{};  ///< [corner]; of a triangle the last one twice
  std::array<float, kCount> nx{}, ny{}, nz{};              ///< normal; 0 where there is no facet
  std::uint32_t of_solid = 0;  ///< bit k: facet k bounds a convex solid that no ray ends in

  void set(std::size_t k, std::span<const Vec3, 4> corners, Vec3 normal);
};

/// The convex hull of two ends: every ray between points of them runs in it. The tests are conservative: what
/// they call outside blocks no such ray, what they do not may still block none. Only what touches an end, or
/// is closer to it than half of where rays start, is in nobody's way.
///
/// Outside is what lies beyond one of these planes: those of the ends, and eight about the axis, each tilted
/// so that it touches both ends (a separating axis each); a facet is outside, too, where its own plane has
/// both ends on one side. Source: Haines & Wallace, "Shaft culling for efficient ray-traced radiosity", 1991,
/// with planes that follow the axis in place of the coordinates.
class Shaft {
 public:
  Shaft(const ShaftEnd& from, const ShaftEnd& to);

  /// Some 10 operations, all planes at once.
  bool may_meet(const Box& box) const;
  /// Bit k: facet k. Some 300 operations, all facets at once.
  std::uint32_t may_meet(const FacetLanes& facets) const {
    std::uint32_t entered = 0;
    return may_meet(facets, entered);
  }
  /// `entered`: those that every ray that meets them comes to from their front.
  std::uint32_t may_meet(const FacetLanes& facets, std::uint32_t& entered) const;
  /// Those that may be met but for solids that are entered there: they are left elsewhere.
  std::uint32_t may_leave(const FacetLanes& facets) const {
    std::uint32_t entered = 0;
    const std::uint32_t met = may_meet(facets, entered);
    return met & ~(entered & facets.of_solid);
  }
  /// Around the end of the rays.
  Box box_of_end() const;

 private:
  static constexpr std::size_t kAround = 8, kPlanes = kAround + 2;

  /// One plane per lane; beyond them nothing is outside.
  using Lanes = std::array<float, 16>;

  void set_plane(std::size_t k, Vec3 normal, float height);
  void tilt_planes(Vec3 axis, float off);

  /// Beyond plane k: normal . (point - middle_) > height. Side by side, for all at once.
  Lanes nx_{}, ny_{}, nz_{}, height_;
  std::array<Vec3, 8> ends_;  ///< corners of both, relative to middle_
  Vec3 middle_;
  float slack_m_, off_m_;  ///< what is closer to an end touches it; how far off their ends rays begin or end
};

}  // namespace engine
