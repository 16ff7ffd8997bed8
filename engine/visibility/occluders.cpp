#include "engine/visibility/occluders.h"

#include <algorithm>
#include <bit>

#include "engine/base/widest.h"

namespace engine {
namespace {

std::vector<Occluder> facets_at_rest(const Patches& patches, const Animation& animation) {
  std::vector<Occluder> facets;
  for (const Facet& facet : patches.facets) {
    const ObjectMotion& motion = animation.objects[facet.object];
    if (motion.is_static(animation.frame_count))
      facets.emplace_back(place(facet, motion.spans[0].pose), facet.is_triangle);
  }
  return facets;
}

std::vector<Box> boxes_of(const std::vector<Occluder>& facets) {
  std::vector<Box> boxes;
  for (const Occluder& facet : facets) boxes.push_back(box_of(facet.corners));
  return boxes;
}

/// Adds those of sixteen facets whose bits are set.
void list(std::uint32_t bits, const Occluder* facets, std::vector<const Occluder*>& to) {
  for (; bits != 0; bits &= bits - 1) to.push_back(facets + std::countr_zero(bits));
}

}  // namespace

Occluder::Occluder(const PlacedFacet& placed, bool is_triangle)
    : corners(placed.corners), origin(placed.origin), normal(placed.normal), sum_max(is_triangle ? 1 : 2) {
  if (is_triangle) corners[3] = corners[2];
  const Vec3 area = cross(placed.edge_u, placed.edge_v);
  const float squared = dot(area, area);
  if (!(squared > 0)) return;
  across_u = (1.0f / squared) * cross(placed.edge_v, area);
  across_v = (1.0f / squared) * cross(area, placed.edge_u);
}

KEYLUME_WIDEST
std::uint32_t crossed_by(const Occluder& facet, const RayLanes& rays) {
  const Vec3 o = facet.origin, n = facet.normal, gu = facet.across_u, gv = facet.across_v;
  std::uint32_t crossed = 0;
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
    const bool inside = (u >= 0.0f) & (v >= 0.0f) & (u <= 1.0f) & (v <= 1.0f) & (u + v <= facet.sum_max);
    const bool through = (before > 0.0f) != (behind > 0.0f);
    crossed |= (inside & through) ? 1u << k : 0u;
  }
  return crossed;
}

StaticOccluders::StaticOccluders(const Patches& patches, const Animation& animation)
    : StaticOccluders(facets_at_rest(patches, animation)) {}

StaticOccluders::StaticOccluders(const std::vector<Occluder>& facets)
    : tree_(boxes_of(facets), FacetLanes::kCount), lanes_(tree_.leaves().size()) {
  for (const BoxTree::Leaf& leaf : tree_.leaves())
    for (std::uint32_t k = leaf.first; k < leaf.end; ++k) {
      const Occluder& facet = facets[tree_.order()[k]];
      lanes_[leaf.number].set(k - leaf.first, facet.corners, facet.normal);
      facets_.push_back(facet);
    }
}

void StaticOccluders::collect(const Shaft& shaft, std::size_t most, ShaftContents& contents) const {
  tree_.each_leaf([&](const Box& box) { return shaft.may_meet(box); },
                  [&](const BoxTree::Leaf& leaf) {
                    list(shaft.may_meet(lanes_[leaf.number]), facets_.data() + leaf.first, contents.at_rest);
                    contents.many_at_rest = contents.at_rest.size() > most;
                    return !contents.many_at_rest;
                  });
}

MovingOccluders::MovingOccluders(const Patches& patches, const Animation& animation,
                                 std::span<const FrameIndex> frames)
    : in_slot_(frames.size()), tree_(place(patches, animation, frames)) {}

std::vector<Box> MovingOccluders::place(const Patches& patches, const Animation& animation,
                                        std::span<const FrameIndex> frames) {
  std::vector<std::vector<const Facet*>> of_object(animation.objects.size());
  for (const Facet& facet : patches.facets) {
    of_object[facet.object].push_back(&facet);
    moving_facets_ += animation.objects[facet.object].is_static(animation.frame_count) ? 0 : 1;
  }
  std::vector<Box> boxes;
  for (std::size_t o = 0; o < of_object.size(); ++o) {
    const ObjectMotion& motion = animation.objects[o];
    if (of_object[o].empty() || motion.is_static(animation.frame_count)) continue;
    const bool listed = moving_facets_ <= kFollowedMax && of_object[o].size() <= kOfObjectMax;
    for (const PlacedRange& range : placed_ranges(motion, frames)) {
      for (std::uint32_t s = range.first_slot; s <= range.last_slot; ++s)
        in_slot_[s].push_back(static_cast<std::uint32_t>(objects_.size()));
      objects_.push_back(place(of_object[o], range, listed));
      boxes.push_back(objects_.back().box);
    }
  }
  return boxes;
}

MovingOccluders::PlacedObject MovingOccluders::place(const std::vector<const Facet*>& facets,
                                                     const PlacedRange& range, bool listed) {
  PlacedObject object{{}, range.first_slot, range.last_slot, static_cast<std::uint32_t>(lanes_.size()), 0};
  for (std::size_t f = 0; f < facets.size(); ++f) {
    Occluder facet(engine::place(*facets[f], *range.pose), facets[f]->is_triangle);
    facet.first_slot = range.first_slot;
    facet.last_slot = range.last_slot;
    const Box box = box_of(facet.corners);
    object.box = f == 0 ? box : join(object.box, box);
    if (!listed) continue;
    if (f % FacetLanes::kCount == 0) lanes_.emplace_back();
    lanes_.back().set(f % FacetLanes::kCount, facet.corners, facet.normal);
    facets_.push_back(facet);
  }
  object.end_block = static_cast<std::uint32_t>(lanes_.size());
  if (object.end_block > object.first_block)
    facets_.resize(lanes_.size() * FacetLanes::kCount, facets_.back());  // the lanes beyond meet nothing
  return object;
}

void MovingOccluders::collect(const Shaft& shaft, bool one_place, std::uint32_t first_slot,
                              std::uint32_t last_slot, ShaftContents& contents) const {
  if (first_slot == last_slot && !one_place) {
    for (const std::uint32_t o : in_slot_[first_slot])
      if (shaft.may_meet(objects_[o].box)) list_facets(objects_[o], shaft, contents);
    return;
  }
  const bool listed = !one_place || moving_facets_ <= kOfAllMax;
  tree_.each_leaf([&](const Box& box) { return shaft.may_meet(box); },
                  [&](const BoxTree::Leaf& leaf) {
                    const PlacedObject& object = objects_[tree_.order()[leaf.first]];
                    if (object.last_slot < first_slot || last_slot < object.first_slot) return true;
                    if (listed) list_facets(object, shaft, contents);
                    if (!listed) contents.many_moving.set(first_slot, last_slot);
                    return listed;
                  });
}

void MovingOccluders::list_facets(const PlacedObject& object, const Shaft& shaft,
                                  ShaftContents& contents) const {
  if (object.first_block == object.end_block) contents.many_moving.set(object.first_slot, object.last_slot);
  for (std::uint32_t b = object.first_block; b < object.end_block; ++b)
    list(shaft.may_meet(lanes_[b]), facets_.data() + std::size_t{b} * FacetLanes::kCount, contents.moving);
}

}  // namespace engine
