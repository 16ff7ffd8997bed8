#include "engine/visibility/coincident.h"
#include "engine/visibility/facet_bvh.h"
#include "engine/visibility/scene_facets.h"

namespace engine {

struct MovingRays::Impl {
  FacetBvh bvh;
  std::uint32_t slot_count;

  bool holds(std::uint32_t item, std::uint32_t slot) const {
    const PlacedFacet& placed = bvh.items()[item];
    return placed.first_slot <= slot && slot <= placed.last_slot;
  }
};

MovingRays::MovingRays(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames)
    : impl_(new Impl{FacetBvh(moving_facets(patches, animation, frames), patches),
                     static_cast<std::uint32_t>(frames.size())}) {}

MovingRays::~MovingRays() = default;

bool MovingRays::empty() const {
  return impl_->bvh.items().empty();
}

void MovingRays::all_hits(const Ray& ray, std::vector<MovingHit>& hits) const {
  hits.clear();
  if (empty()) return;
  thread_local std::vector<ItemHit> found;
  impl_->bvh.all_hits(ray, found);
  for (const ItemHit& hit : found) {
    const PlacedFacet& placed = impl_->bvh.items()[hit.item];
    MovingHit next;
    static_cast<SurfaceHit&>(next) = {hit.distance, placed.facet, hit.u, hit.v,
                                      impl_->bvh.is_front(hit.item, ray.direction)};
    next.first_slot = placed.first_slot;
    next.last_slot = placed.last_slot;
    add_crossing(hits, next);
  }
}

SlotMask MovingRays::blocked(const Ray& ray) const {
  SlotMask mask;
  if (empty()) return mask;
  SlotMask all;
  all.set(0, impl_->slot_count - 1);
  impl_->bvh.any_hit(ray, [&](std::uint32_t item) {
    mask.set(impl_->bvh.items()[item].first_slot, impl_->bvh.items()[item].last_slot);
    return mask.bits == all.bits;
  });
  return mask;
}

bool MovingRays::occluded(const Ray& ray, std::uint32_t slot) const {
  if (empty()) return false;
  return impl_->bvh.any_hit(ray, [&](std::uint32_t item) { return impl_->holds(item, slot); });
}

bool MovingRays::nearest(const Ray& ray, std::uint32_t slot, SurfaceHit& hit) const {
  ItemHit found;
  if (empty()) return false;
  if (!impl_->bvh.nearest(ray, found, [&](std::uint32_t item) { return impl_->holds(item, slot); }))
    return false;
  hit = {found.distance, impl_->bvh.items()[found.item].facet, found.u, found.v,
         impl_->bvh.is_front(found.item, ray.direction)};
  return true;
}

}  // namespace engine
