#include <algorithm>
#include <tuple>

#include "engine/visibility/coincident.h"
#include "engine/visibility/facet_bvh.h"
#include "engine/visibility/moving_shape.h"
#include "engine/visibility/scene_facets.h"

namespace engine {
namespace {

using Shapes = std::vector<std::unique_ptr<MovingShape>>;

/// [object] -> its facets.
std::vector<std::vector<std::uint32_t>> facets_of_objects(const Patches& patches,
                                                          const Animation& animation) {
  std::vector<std::vector<std::uint32_t>> facets(animation.objects.size());
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) facets[patches.facets[f].object].push_back(f);
  return facets;
}

/// Takes objects of more than `flat_facets_max` facets; marks these in `taken`.
Shapes take_shapes(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
                   std::size_t flat_facets_max, std::vector<bool>& taken) {
  taken.assign(animation.objects.size(), false);
  Shapes shapes;
  const auto facets = facets_of_objects(patches, animation);
  for (std::size_t object = 0; object < facets.size(); ++object) {
    const ObjectMotion& motion = animation.objects[object];
    if (facets[object].size() <= flat_facets_max || motion.is_static(animation.frame_count)) continue;
    auto shape = MovingShape::of(facets[object], patches, motion, frames);
    if (!shape) continue;
    taken[object] = true;
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

bool is_earlier(const MovingHit& a, const MovingHit& b) {
  return std::tie(a.distance, a.facet, a.first_slot) < std::tie(b.distance, b.facet, b.first_slot);
}

/// The one that MovingRays::nearest answers; facets that share a distance are of different objects.
bool is_nearer(const SurfaceHit& a, const SurfaceHit& b) {
  if (a.distance != b.distance) return a.distance < b.distance;
  return a.front != b.front ? a.front : a.facet < b.facet;
}

}  // namespace

struct MovingRays::Impl {
  std::uint32_t slot_count;
  std::vector<bool> in_shapes;  ///< [object]
  Shapes shapes;
  FacetBvh flat;  ///< the facets of all other objects

  Impl(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
       std::size_t flat_facets_max)
      : slot_count(static_cast<std::uint32_t>(frames.size())),
        shapes(take_shapes(patches, animation, frames, flat_facets_max, in_shapes)),
        flat(flat_facets(patches, animation, frames), patches) {}

  std::vector<PlacedFacet> flat_facets(const Patches& patches, const Animation& animation,
                                       std::span<const FrameIndex> frames) const {
    return moving_facets(patches, animation, frames,
                         [&](std::uint32_t object) { return !in_shapes[object]; });
  }
  bool holds(std::uint32_t item, std::uint32_t slot) const {
    const PlacedFacet& placed = flat.items()[item];
    return placed.first_slot <= slot && slot <= placed.last_slot;
  }
};

MovingRays::MovingRays(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
                       std::size_t flat_facets_max)
    : impl_(new Impl(patches, animation, frames, flat_facets_max)) {}

MovingRays::~MovingRays() = default;

bool MovingRays::empty() const {
  return impl_->flat.items().empty() && impl_->shapes.empty();
}

void MovingRays::all_hits(const Ray& ray, std::vector<MovingHit>& hits) const {
  hits.clear();
  thread_local std::vector<ItemHit> found;
  thread_local std::vector<MovingHit> all;
  all.clear();
  impl_->flat.all_hits(ray, found);
  for (const ItemHit& hit : found) {
    const PlacedFacet& placed = impl_->flat.items()[hit.item];
    MovingHit next;
    static_cast<SurfaceHit&>(next) = {hit.distance, placed.facet, hit.u, hit.v,
                                      impl_->flat.is_front(hit.item, ray.direction)};
    next.first_slot = placed.first_slot;
    next.last_slot = placed.last_slot;
    all.push_back(next);
  }
  for (const auto& shape : impl_->shapes) shape->add_hits(ray, all);
  std::sort(all.begin(), all.end(), is_earlier);
  for (const MovingHit& next : all) add_crossing(hits, next);
}

SlotMask MovingRays::blocked(const Ray& ray) const {
  SlotMask mask;
  if (empty()) return mask;
  for (const auto& shape : impl_->shapes) shape->block(ray, mask);
  SlotMask all;
  all.set(0, impl_->slot_count - 1);
  impl_->flat.any_hit(ray, [&](std::uint32_t item) {
    mask.set(impl_->flat.items()[item].first_slot, impl_->flat.items()[item].last_slot);
    return mask.bits == all.bits;
  });
  return mask;
}

bool MovingRays::occluded(const Ray& ray, std::uint32_t slot) const {
  for (const auto& shape : impl_->shapes)
    if (shape->occluded(ray, slot)) return true;
  if (impl_->flat.items().empty()) return false;
  return impl_->flat.any_hit(ray, [&](std::uint32_t item) { return impl_->holds(item, slot); });
}

bool MovingRays::nearest(const Ray& ray, std::uint32_t slot, SurfaceHit& hit) const {
  bool met = false;
  const auto take = [&](const SurfaceHit& next) {
    if (!met || is_nearer(next, hit)) hit = next;
    met = true;
  };
  SurfaceHit next;
  for (const auto& shape : impl_->shapes)
    if (shape->nearest(ray, slot, next)) take(next);
  ItemHit found;
  if (!impl_->flat.items().empty() &&
      impl_->flat.nearest(ray, found, [&](std::uint32_t item) { return impl_->holds(item, slot); }))
    take({found.distance, impl_->flat.items()[found.item].facet, found.u, found.v,
          impl_->flat.is_front(found.item, ray.direction)});
  return met;
}

}  // namespace engine
