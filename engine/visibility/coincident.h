// Two hits that are one crossing of the surface. Internal to engine/visibility.
#pragma once

#include <cmath>
#include <vector>

#include "engine/visibility/ray_scene.h"

namespace engine {

inline bool is_same_distance(const SurfaceHit& a, const SurfaceHit& b) {
  constexpr float kRelative = 4e-7f;  // a few units in the last place of the distance
  return std::abs(a.distance - b.distance) <= kRelative * std::abs(b.distance);
}

/// The last hit in `hits` (sorted by distance) that is the same crossing as `next` and that `meets` accepts,
/// or null. A ray through an edge that two facets share meets both at one distance, from the same side: it
/// crosses the surface once. Sheets that touch back to back are met from opposite sides and stay two
/// crossings, so between two hits of one surface there may be those of another, or of other poses.
template <class Hit, class Meets>
const Hit* same_crossing(const std::vector<Hit>& hits, const Hit& next, Meets&& meets) {
  for (std::size_t k = hits.size(); k > 0 && is_same_distance(hits[k - 1], next); --k)
    if (hits[k - 1].front == next.front && meets(hits[k - 1])) return &hits[k - 1];
  return nullptr;
}

}  // namespace engine
