#include "engine/visibility/scene_facets.h"

namespace engine {

std::vector<PlacedFacet> static_facets(const Patches& patches, const Animation& animation) {
  std::vector<PlacedFacet> placed;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const ObjectMotion& motion = animation.objects[patches.facets[f].object];
    if (!motion.is_static(animation.frame_count)) continue;
    placed.push_back(place(patches.facets[f], motion.spans[0].pose));
    placed.back().facet = f;
  }
  return placed;
}

std::vector<PlacedFacet> moving_facets(const Patches& patches, const Animation& animation,
                                       std::span<const FrameIndex> frames,
                                       const std::function<bool(std::uint32_t object)>& is_wanted) {
  std::vector<std::vector<PlacedRange>> ranges(animation.objects.size());
  for (std::uint32_t o = 0; o < ranges.size(); ++o)
    if (!animation.objects[o].is_static(animation.frame_count) && (!is_wanted || is_wanted(o)))
      ranges[o] = placed_ranges(animation.objects[o], frames);

  std::vector<PlacedFacet> placed;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f)
    for (const PlacedRange& range : ranges[patches.facets[f].object]) {
      placed.push_back(place(patches.facets[f], *range.pose));
      placed.back().facet = f;
      placed.back().first_slot = range.first_slot;
      placed.back().last_slot = range.last_slot;
    }
  return placed;
}

}  // namespace engine
