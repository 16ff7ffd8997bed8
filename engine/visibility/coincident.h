// Two hits that are one crossing of the surface. Internal to engine/visibility and engine/lines.
#pragma once

#include <cmath>
#include <vector>

#include "engine/visibility/ray_scene.h"

namespace engine {

template <class Hit>
bool is_same_distance(const Hit& a, const Hit& b) {
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

inline bool overlap(const MovingHit& a, const MovingHit& b) {
  return a.first_slot <= b.last_slot && b.first_slot <= a.last_slot;
}

/// Appends `next` for those of its slots in which no hit before is the same crossing.
inline void add_crossing(std::vector<MovingHit>& hits, const MovingHit& next) {
  const MovingHit* met = same_crossing(hits, next, [&](const MovingHit& hit) { return overlap(hit, next); });
  if (!met) return hits.push_back(next);
  MovingHit earlier = next, later = next;
  earlier.last_slot = met->first_slot - 1;  // used only where there are earlier slots
  later.first_slot = met->last_slot + 1;
  const bool has_earlier = next.first_slot < met->first_slot, has_later = met->last_slot < next.last_slot;
  if (has_earlier) add_crossing(hits, earlier);
  if (has_later) add_crossing(hits, later);
}

}  // namespace engine
