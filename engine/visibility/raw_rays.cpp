#include "engine/visibility/raw_rays.h"

#include "engine/visibility/facet_bvh.h"
#include "engine/visibility/scene_facets.h"

namespace engine {

struct RawRays::Impl {
  FacetBvh at_rest, moving;
};

RawRays::RawRays(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
                 bool robust)
    : impl_(new Impl{
          FacetBvh(static_facets(patches, animation), patches,
                   robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE),
          FacetBvh(moving_facets(patches, animation, frames), patches,
                   robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE),
      }) {}

RawRays::~RawRays() = default;

std::uint64_t RawRays::nearest(std::span<const Ray> rays) const {
  std::uint64_t hits = 0;
  for (const Ray& ray : rays)
    for (const FacetBvh* bvh : {&impl_->at_rest, &impl_->moving})
      hits += bvh->hits_anything_first(ray) ? 1 : 0;
  return hits;
}

}  // namespace engine
