// Two hits that are one crossing of the surface. Internal to engine/visibility.
#pragma once

#include <cmath>

#include "engine/visibility/ray_scene.h"

namespace engine {

/// A ray through an edge that two facets share meets both at one distance, from the same side: it crosses the
/// surface once. (Sheets that touch back to back are met from opposite sides and stay two crossings.)
inline bool is_same_crossing(const SurfaceHit& a, const SurfaceHit& b) {
  constexpr float kRelative = 4e-7f;  // a few units in the last place of the distance
  return a.front == b.front && std::abs(a.distance - b.distance) <= kRelative * std::abs(b.distance);
}

}  // namespace engine
