#include "engine/direct/scene_reach.h"

namespace engine {
namespace {

struct Extent {
  Vec3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  void add(Vec3 p) {
    low = min(low, p);
    high = max(high, p);
  }
  bool empty() const { return low.x > high.x; }
  Vec3 corner(int c) const {
    return {c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z};
  }
};

}  // namespace

float scene_reach_m(const Patches& patches, const Animation& animation) {
  std::vector<Extent> of_object(animation.objects.size());
  for (const Facet& facet : patches.facets)
    for (std::size_t c = 0; c < (facet.is_triangle ? 3u : 4u); ++c)
      of_object[facet.object].add(facet.corners[c]);

  Extent all;
  for (std::size_t o = 0; o < of_object.size(); ++o) {
    if (of_object[o].empty()) continue;
    for (const PoseSpan& span : animation.objects[o].spans)
      for (int c = 0; c < 8; ++c) all.add(transform_point(span.pose, of_object[o].corner(c)));
  }
  return all.empty() ? 1.0f : 1.001f * length(all.high - all.low) + 1e-6f;
}

}  // namespace engine
