#include "engine/direct/clearance.h"

#include <algorithm>
#include <cmath>

namespace engine {

Roughness roughness_of(const PlacedFacet& placed, bool is_triangle) {
  Roughness roughness;
  const auto& corners = placed.corners;
  for (std::size_t c = 0; c < (is_triangle ? 3u : 4u); ++c)
    roughness.largest_coordinate_m = std::max({roughness.largest_coordinate_m, std::abs(corners[c].x),
                                               std::abs(corners[c].y), std::abs(corners[c].z)});
  if (!is_triangle) roughness.bend_m = length((corners[2] - corners[3]) - (corners[1] - corners[0]));
  return roughness;
}

}  // namespace engine
