#include "engine/visibility/occluders.h"

#include <algorithm>
#include <bit>
#include <map>

#include "engine/base/widest.h"

namespace engine {
namespace {

std::vector<Occluder> facets_at_rest(const Patches& patches, const Animation& animation) {
  const std::vector<std::uint32_t> solids = find_convex_solids(patches.facets);
  std::vector<Occluder> facets;
  for (std::size_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    const ObjectMotion& motion = animation.objects[facet.object];
    if (!motion.is_static(animation.frame_count)) continue;
    facets.emplace_back(place(facet, motion.spans[0].pose), facet.is_triangle);
    facets.back().solid = solids[f];
  }
  return facets;
}

/// Numbers the solids of an object from 0 on.
void number_anew(std::vector<std::uint32_t>& solids) {
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::uint32_t& solid : solids)
    if (solid != kNoSolid)
      solid = numbers.try_emplace(solid, static_cast<std::uint32_t>(numbers.size())).first->second;
}

/// Takes the facet into the box of its solid.
void join_solid(const Occluder& facet, std::vector<Box>& solids) {
  if (facet.solid == kNoSolid) return;
  const Box box = box_of(facet.corners);
  if (facet.solid >= solids.size())
    solids.resize(facet.solid + 1, {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}});
  solids[facet.solid] = join(solids[facet.solid], box);
}

bool overlap(const Box& a, const Box& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

/// Which facets in a shaft must be looked at: where a ray enters a convex solid that it does not end in it
/// need not be.
struct Sieve {
  const Shaft& shaft;
  const std::vector<Box>& solids;
  Box end = shaft.box_of_end();

  bool ends_outside(const Occluder& facet) const {
    return facet.solid != kNoSolid && !overlap(solids[facet.solid], end);
  }
  /// Calls use(k, ends outside of its solid) for those of a block.
  template <class Use>
  void each(const FacetLanes& lanes, const Occluder* facets, Use&& use) const;
};

std::vector<Box> boxes_of(const std::vector<Occluder>& facets) {
  std::vector<Box> boxes;
  for (const Occluder& facet : facets) boxes.push_back(box_of(facet.corners));
  return boxes;
}

/// Calls use(k) for the bits that are set, in order.
template <class Use>
void each_bit(std::uint32_t bits, Use&& use) {
  for (; bits != 0; bits &= bits - 1) use(static_cast<std::size_t>(std::countr_zero(bits)));
}

template <class Use>
void Sieve::each(const FacetLanes& lanes, const Occluder* facets, Use&& use) const {
  std::uint32_t entered = 0;
  each_bit(shaft.may_meet(lanes, entered), [&](std::size_t k) {
    const bool outside = ends_outside(facets[k]);
    if (!outside || ((entered >> k) & 1) == 0) use(k, outside);
  });
}

/// Calls use(block, k) for those of a list that may meet the shaft.
template <class Use>
void each_in(const OccluderList& list, const Shaft& shaft, Use&& use) {
  for (std::size_t block = 0; block < list.lanes.size(); ++block)
    each_bit(shaft.may_leave(list.lanes[block]), [&](std::size_t k) { use(block, k); });
}

std::size_t size_of(const OccluderList& list) {
  return list.facets.size();
}
std::size_t size_of(const std::vector<const Occluder*>& list) {
  return list.size();
}

void sift(const OccluderList& list, const Shaft& shaft, OccluderList& found) {
  each_in(list, shaft, [&](std::size_t block, std::size_t k) {
    found.add(list.lanes[block], k, list.facets[block * FacetLanes::kCount + k],
              ((list.lanes[block].of_solid >> k) & 1) != 0);
  });
}

void sift(const OccluderList& list, const Shaft& shaft, std::vector<const Occluder*>& found) {
  each_in(list, shaft, [&](std::size_t block, std::size_t k) {
    found.push_back(list.facets[block * FacetLanes::kCount + k]);
  });
}

template <class Found>
void collect_all(const OccluderSource& source, const Shaft& shaft, Found& found) {
  found.clear();
  source.at_rest.collect(shaft, source.most, found);
  if (source.first_slot < source.end_slot)
    source.moving.collect(shaft, source.first_slot, source.end_slot - 1, found);
}

template <class Found>
void sift_all(const OccluderSource& source, const Candidates& candidates, const Shaft& shaft, Found& found) {
  found.clear();
  if (candidates.many_at_rest) {
    source.at_rest.collect(shaft, source.most, found);
  } else {
    sift(candidates.at_rest, shaft, found.at_rest);
    found.many_at_rest = size_of(found.at_rest) > source.most;
  }
  sift(candidates.moving, shaft, found.moving);
  if (candidates.some_slots_many())
    found.many_moving = source.moving.unlisted(shaft, source.first_slot, source.end_slot - 1);
}

}  // namespace

Occluder::Occluder(const PlacedFacet& placed, bool is_triangle)
    : origin(placed.origin), normal(placed.normal), sum_max(is_triangle ? 1 : 2), corners(placed.corners) {
  if (is_triangle) corners[3] = corners[2];
  const Vec3 area = cross(placed.edge_u, placed.edge_v);
  const float squared = dot(area, area);
  if (!(squared > 0)) return;
  across_u = (1.0f / squared) * cross(placed.edge_v, area);
  across_v = (1.0f / squared) * cross(area, placed.edge_u);
}

std::uint32_t crossed_by(const Occluder& facet, const RayLanes& rays) {
  std::uint32_t crossed = 0;
  crossed_by(facet, &rays, 1, &crossed);
  return crossed;
}

KEYLUME_WIDEST
void crossed_by(const Occluder& facet, const RayLanes* blocks, std::size_t count, std::uint32_t* crossed) {
  const Vec3 o = facet.origin, n = facet.normal, gu = facet.across_u, gv = facet.across_v;
  const float sum_max = facet.sum_max;
  for (std::size_t b = 0; b < count; ++b) {
    const RayLanes& rays = blocks[b];
    std::uint32_t bits = 0;
    for (std::uint32_t k = 0; k < RayLanes::kCount; ++k) {
      const float x = rays.ox[k] - o.x, y = rays.oy[k] - o.y, z = rays.oz[k] - o.z;
      const float before = n.x * x + n.y * y + n.z * z;
      const float along = n.x * rays.dx[k] + n.y * rays.dy[k] + n.z * rays.dz[k];
      const float behind = before + along;
      const float t = -before / along;  // used only where the ends are on different sides: along is not 0
      const float u =
          gu.x * x + gu.y * y + gu.z * z + t * (gu.x * rays.dx[k] + gu.y * rays.dy[k] + gu.z * rays.dz[k]);
      const float v =
          gv.x * x + gv.y * y + gv.z * z + t * (gv.x * rays.dx[k] + gv.y * rays.dy[k] + gv.z * rays.dz[k]);
      const bool inside = (u >= 0.0f) & (v >= 0.0f) & (u <= 1.0f) & (v <= 1.0f) & (u + v <= sum_max);
      const bool through = (before > 0.0f) != (behind > 0.0f);
      bits |= (inside & through) ? 1u << k : 0u;
    }
    crossed[b] = bits;
  }
}

StaticOccluders::StaticOccluders(const Patches& patches, const Animation& animation)
    : StaticOccluders(facets_at_rest(patches, animation)) {}

StaticOccluders::StaticOccluders(std::vector<Occluder> facets)
    : tree_(boxes_of(facets), FacetLanes::kCount), lanes_(tree_.leaves().size()) {
  for (const BoxTree::Leaf& leaf : tree_.leaves())
    for (std::uint32_t k = leaf.first; k < leaf.end; ++k) {
      const Occluder& facet = facets[tree_.order()[k]];
      lanes_[leaf.number].set(k - leaf.first, facet.corners, facet.normal);
      if (facet.solid != kNoSolid) lanes_[leaf.number].of_solid |= 1u << (k - leaf.first);
      facets_.push_back(facet);
      join_solid(facet, solids_);
    }
}

/// Calls use(lanes, k, facet, ends outside of its solid) for those that may meet the shaft, as long as it
/// answers true after a leaf.
template <class Use, class GoOn>
void StaticOccluders::each_block(const Shaft& shaft, Use&& use, GoOn&& go_on) const {
  const Sieve sieve{shaft, solids_};
  tree_.each_leaf([&](const Box& box) { return shaft.may_meet(box); },
                  [&](const BoxTree::Leaf& leaf) {
                    const FacetLanes& lanes = lanes_[leaf.number];
                    const Occluder* facets = facets_.data() + leaf.first;
                    sieve.each(lanes, facets,
                               [&](std::size_t k, bool outside) { use(lanes, k, facets + k, outside); });
                    return go_on();
                  });
}

void StaticOccluders::collect(const Shaft& shaft, std::size_t most, ShaftContents& contents) const {
  each_block(
      shaft,
      [&](const FacetLanes&, std::size_t, const Occluder* facet, bool) { contents.at_rest.push_back(facet); },
      [&] { return !(contents.many_at_rest = contents.at_rest.size() > most); });
}

void StaticOccluders::collect(const Shaft& shaft, std::size_t most, Candidates& candidates) const {
  OccluderList& found = candidates.at_rest;
  each_block(
      shaft,
      [&](const FacetLanes& lanes, std::size_t k, const Occluder* facet, bool outside) {
        found.add(lanes, k, facet, outside);
      },
      [&] { return !(candidates.many_at_rest = found.facets.size() > most); });
}

MovingOccluders::MovingOccluders(const Patches& patches, const Animation& animation,
                                 std::span<const FrameIndex> frames)
    : in_slot_(frames.size()), tree_(place(patches, animation, frames)) {}

std::vector<Box> MovingOccluders::place(const Patches& patches, const Animation& animation,
                                        std::span<const FrameIndex> frames) {
  const std::vector<std::uint32_t> solids = find_convex_solids(patches.facets);
  std::vector<ListedFacets> of_object(animation.objects.size());
  for (std::size_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    if (animation.objects[facet.object].is_static(animation.frame_count)) continue;
    of_object[facet.object].facets.push_back(&facet);
    of_object[facet.object].solids.push_back(solids[f]);
    ++moving_facets_;
  }
  for (ListedFacets& facets : of_object) number_anew(facets.solids);
  std::vector<Box> boxes;
  for (std::size_t o = 0; o < of_object.size(); ++o) {
    const ObjectMotion& motion = animation.objects[o];
    if (of_object[o].facets.empty()) continue;
    const bool listed = moving_facets_ <= kOfAllMax && of_object[o].facets.size() <= kOfObjectMax;
    for (const PlacedRange& range : placed_ranges(motion, frames)) {
      for (std::uint32_t s = range.first_slot; s <= range.last_slot; ++s)
        in_slot_[s].push_back(static_cast<std::uint32_t>(objects_.size()));
      objects_.push_back(place(of_object[o], range, listed));
      boxes.push_back(objects_.back().box);
    }
  }
  return boxes;
}

MovingOccluders::PlacedObject MovingOccluders::place(const ListedFacets& of, const PlacedRange& range,
                                                     bool listed) {
  PlacedObject object{{}, range.first_slot, range.last_slot, static_cast<std::uint32_t>(lanes_.size()), 0};
  const auto first_solid = static_cast<std::uint32_t>(solids_.size());
  for (std::size_t f = 0; f < of.facets.size(); ++f) {
    Occluder facet(engine::place(*of.facets[f], *range.pose), of.facets[f]->is_triangle);
    if (listed && of.solids[f] != kNoSolid) facet.solid = first_solid + of.solids[f];
    facet.first_slot = range.first_slot;
    facet.last_slot = range.last_slot;
    const Box box = box_of(facet.corners);
    object.box = f == 0 ? box : join(object.box, box);
    if (!listed) continue;
    const bool next_block = f % FacetLanes::kCount == 0;
    if (next_block) lanes_.emplace_back();
    if (next_block) boxes_.push_back(box);
    boxes_.back() = join(boxes_.back(), box);
    lanes_.back().set(f % FacetLanes::kCount, facet.corners, facet.normal);
    if (facet.solid != kNoSolid) lanes_.back().of_solid |= 1u << (f % FacetLanes::kCount);
    facets_.push_back(facet);
    join_solid(facet, solids_);
  }
  object.end_block = static_cast<std::uint32_t>(lanes_.size());
  if (object.end_block > object.first_block)
    facets_.resize(lanes_.size() * FacetLanes::kCount, facets_.back());  // the lanes beyond meet nothing
  return object;
}

template <class Use>
void MovingOccluders::each_object(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
                                  Use&& use) const {
  if (first_slot == last_slot) {
    for (const std::uint32_t o : in_slot_[first_slot])
      if (shaft.may_meet(objects_[o].box)) use(objects_[o]);
    return;
  }
  tree_.each_leaf([&](const Box& box) { return shaft.may_meet(box); },
                  [&](const BoxTree::Leaf& leaf) {
                    const PlacedObject& object = objects_[tree_.order()[leaf.first]];
                    if (object.last_slot >= first_slot && last_slot >= object.first_slot) use(object);
                    return true;
                  });
}

/// Calls use(lanes, k, facet, ends outside of its solid) for those of the object that may meet the shaft.
template <class Use>
void MovingOccluders::each_block(const PlacedObject& object, const Shaft& shaft, Use&& use) const {
  const Sieve sieve{shaft, solids_};
  const bool one_block = object.end_block == object.first_block + 1;
  for (std::uint32_t b = object.first_block; b < object.end_block; ++b) {
    if (!one_block && !shaft.may_meet(boxes_[b])) continue;
    const Occluder* facets = facets_.data() + std::size_t{b} * FacetLanes::kCount;
    sieve.each(lanes_[b], facets,
               [&](std::size_t k, bool outside) { use(lanes_[b], k, facets + k, outside); });
  }
}

template <class Use>
void MovingOccluders::collect_by(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
                                 SlotMask& many, Use&& use) const {
  each_object(shaft, first_slot, last_slot, [&](const PlacedObject& object) {
    if (object.first_block == object.end_block)
      many.set(std::max(first_slot, object.first_slot), std::min(last_slot, object.last_slot));
    else
      each_block(object, shaft, use);
  });
}

void MovingOccluders::collect(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
                              ShaftContents& contents) const {
  collect_by(
      shaft, first_slot, last_slot, contents.many_moving,
      [&](const FacetLanes&, std::size_t, const Occluder* facet, bool) { contents.moving.push_back(facet); });
}

void MovingOccluders::collect(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
                              Candidates& candidates) const {
  collect_by(shaft, first_slot, last_slot, candidates.many_moving,
             [&](const FacetLanes& lanes, std::size_t k, const Occluder* facet, bool outside) {
               candidates.moving.add(lanes, k, facet, outside);
             });
}

void OccluderList::add(const FacetLanes& from, std::size_t k, const Occluder* facet, bool of_solid) {
  const std::size_t to = facets.size() % FacetLanes::kCount;
  if (to == 0) lanes.emplace_back();
  FacetLanes& last = lanes.back();
  for (std::size_t c = 0; c < 4; ++c) {
    last.x[c][to] = from.x[c][k];
    last.y[c][to] = from.y[c][k];
    last.z[c][to] = from.z[c][k];
  }
  last.nx[to] = from.nx[k];
  last.ny[to] = from.ny[k];
  last.nz[to] = from.nz[k];
  if (of_solid) last.of_solid |= 1u << to;
  facets.push_back(facet);
}

void Candidates::clear() {
  at_rest.clear();
  moving.clear();
  many_at_rest = false;
  many_moving = {};
}

SlotMask MovingOccluders::unlisted(const Shaft& shaft, std::uint32_t first_slot,
                                   std::uint32_t last_slot) const {
  SlotMask slots;
  each_object(shaft, first_slot, last_slot, [&](const PlacedObject& object) {
    if (object.first_block == object.end_block)
      slots.set(std::max(first_slot, object.first_slot), std::min(last_slot, object.last_slot));
  });
  return slots;
}

void collect(const OccluderSource& source, const Shaft& shaft, Candidates& found) {
  collect_all(source, shaft, found);
}

void collect(const OccluderSource& source, const Shaft& shaft, ShaftContents& found) {
  collect_all(source, shaft, found);
}

void sift(const OccluderSource& source, const Candidates& candidates, const Shaft& shaft, Candidates& found) {
  sift_all(source, candidates, shaft, found);
}

void sift(const OccluderSource& source, const Candidates& candidates, const Shaft& shaft,
          ShaftContents& found) {
  sift_all(source, candidates, shaft, found);
}

}  // namespace engine
