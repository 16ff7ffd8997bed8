// How much of a polygon's light reaches a point, in closed form.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/base/vec3.h"

namespace engine {

/// Form factor from the surface element at `point` with unit normal `normal` to a planar polygon, without
/// occluders, clipped at the element's horizon:
///
///     F = 1 / (2 pi) | sum_k gamma_k  n . (r_k x r_k+1) / |r_k x r_k+1| |    [-], 0 .. 1
///
/// r_k are the vectors from the point to the corners, gamma_k the angle between r_k and r_k+1. Irradiance
/// from a polygon of uniform exitance E is E F. Which side of the polygon the point is on does not matter.
/// `corners`: 3 .. 8, planar.
/// Source: Lambert, Photometria, 1760; Baum, Rushmeier & Winget, SIGGRAPH 1989.
float point_to_polygon_form_factor(Vec3 point, Vec3 normal, std::span<const Vec3> corners);

/// Points side by side.  [m]
struct PointArrays {
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t count = 0;
};

/// The part of a polygon above a plane, for many points of that plane: it is clipped once for all of them.
class PolygonOverPlane {
 public:
  /// The plane: through `origin` with the unit normal `normal`. `corners` as above, at most 4 of them; their
  /// front is where they turn counter-clockwise.
  PolygonOverPlane(Vec3 origin, Vec3 normal, std::span<const Vec3> corners, Vec3 polygon_normal);

  /// factors[k]: the form factor from point k of the plane, to 1e-6; 0 from behind the polygon. Sixteen at a
  /// time; some 100 operations per point and corner.
  void form_factors(const PointArrays& points, float* factors) const;

 private:
  std::array<Vec3, 5> corners_;
  std::uint32_t count_ = 0;
  Vec3 normal_;  ///< of the plane
  Vec3 front_;   ///< of the polygon
};

}  // namespace engine
