// How far off their surfaces shadow rays start and end.
#pragma once

#include <algorithm>

#include "engine/direct/light_sampling.h"

namespace engine {

/// What rounding can do to the points of a placed facet.
struct Roughness {
  float largest_coordinate_m = 0;  ///< of its corners, absolute
  float bend_m = 0;  ///< how far the fourth corner of a near parallelogram is off origin + edge_u + edge_v
};

Roughness roughness_of(const PlacedFacet& placed, bool is_triangle);

/// How far a ray between a point of `here` and one of `there` stays off `here`, so that it meets neither end
/// [m]:
///
///     4e-6 max(|coordinate| of the corners of both) + bend of `here`
///
/// 4e-6 is 64 roundings of a float. Corners, edges, the point made of them and the ray's own ends are off by
/// some ten roundings of the largest of these coordinates, and so is Embree's distance to the plane of a
/// facet, which also grows with the length of the ray: hence those of both ends. It knows of nothing but
/// these two facets: what else is in the scene, how far away, and in which frames, has no say in it. 0.06 mm
/// in a room of 30 m about the origin, 4 mm at a distance of 1 km from it.
inline float clearance_m(const Roughness& here, const Roughness& there) {
  return 4e-6f * std::max(here.largest_coordinate_m, there.largest_coordinate_m) + here.bend_m;
}

}  // namespace engine
