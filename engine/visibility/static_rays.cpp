#include <mutex>

#include "engine/visibility/coincident.h"
#include "engine/visibility/facet_bvh.h"
#include "engine/visibility/line_scene.h"
#include "engine/visibility/scene_facets.h"

namespace engine {
struct StaticRays::Impl {
  FacetBvh bvh;
  std::once_flag lines_once;
  std::unique_ptr<const LineScene> lines;

  SurfaceHit surface_hit(const ItemHit& hit, Vec3 direction) const {
    return {hit.distance, bvh.items()[hit.item].facet, hit.u, hit.v, bvh.is_front(hit.item, direction)};
  }
};

StaticRays::StaticRays(const Patches& patches, const Animation& animation)
    : impl_(new Impl{FacetBvh(static_facets(patches, animation), patches), {}, {}}) {}

StaticRays::~StaticRays() = default;

void StaticRays::all_hits(const Ray& ray, std::vector<SurfaceHit>& hits) const {
  thread_local std::vector<ItemHit> found;
  impl_->bvh.all_hits(ray, found);
  hits.clear();
  for (const ItemHit& hit : found) {
    const SurfaceHit next = impl_->surface_hit(hit, ray.direction);
    if (!same_crossing(hits, next, [](const SurfaceHit&) { return true; })) hits.push_back(next);
  }
}

LineScene StaticRays::line_scene(const Patches& patches, const Animation& animation) const {
  std::call_once(impl_->lines_once, [&] {
    impl_->lines = std::make_unique<const LineScene>(LineScene::at_rest(patches, animation));
  });
  return impl_->lines->of(patches);
}

bool StaticRays::occluded(const Ray& ray) const {
  return impl_->bvh.any_hit(ray);
}

bool StaticRays::nearest(const Ray& ray, SurfaceHit& hit) const {
  ItemHit found;
  if (!impl_->bvh.nearest(ray, found, [](std::uint32_t) { return true; })) return false;
  hit = impl_->surface_hit(found, ray.direction);
  return true;
}

}  // namespace engine
