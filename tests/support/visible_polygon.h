// What a point sees of a polygon past others, exactly: for form factors without chance. Double precision.
#pragma once

#include <array>
#include <vector>

namespace tests {

using Point = std::array<double, 3>;      ///< [m]
using PointPolygon = std::vector<Point>;  ///< planar and convex, corners in either order round

Point operator+(const Point& a, const Point& b);
Point operator-(const Point& a, const Point& b);
Point operator*(double s, const Point& a);
double dot(const Point& a, const Point& b);
Point cross(const Point& a, const Point& b);

/// The part of `polygon` on the side of the plane n.p = d where n.p >= d; empty if none of it is.
PointPolygon clipped(const PointPolygon& polygon, const Point& n, double d);

/// The cone of points that a convex polygon hides from the origin.
class Shadow {
 public:
  /// `polygon` must not contain the origin in its plane.
  explicit Shadow(const PointPolygon& polygon);

  /// Replaces `pieces` by convex pieces of what of them lies outside of the shadow. Points in the polygon's
  /// own plane are seen.
  void subtract_from(std::vector<PointPolygon>& pieces) const;

 private:
  struct Plane {
    Point normal;
    double offset = 0;
  };
  std::vector<Plane> planes_;  ///< the shadow is where n.p > offset for all of them
};

/// Form factor from a patch at the origin with unit normal `n` to a polygon on the side of n.p >= 0.
/// Source: Lambert's formula,  F = | sum_k gamma_k n . (v_k x v_k+1) / |v_k x v_k+1| | / 2 pi,  gamma_k:
/// angle that edge k subtends.
double lambert(const PointPolygon& polygon, const Point& n);

}  // namespace tests
