#include "engine/direct/window_lights.h"

namespace engine {
namespace {

SlotMask lit_slots(const Animation& animation, std::uint32_t material, std::span<const FrameIndex> frames) {
  SlotMask lit;
  for (std::uint32_t slot = 0; slot < frames.size(); ++slot)
    if (max_channel(animation.emission.exitance(material, frames[slot])) > 0) lit.set(slot, slot);
  return lit;
}

}  // namespace

bool narrow_to_lit(const SlotMask& lit, std::uint32_t& first, std::uint32_t& last) {
  while (first <= last && !lit.test(first)) ++first;
  while (first < last && !lit.test(last)) --last;
  return first <= last;
}

std::vector<WindowLight> place_window_lights(const Patches& patches, const Animation& animation,
                                             std::span<const FrameIndex> frames) {
  std::vector<WindowLight> lights;
  for (const Light& light : find_lights(patches, animation)) {
    const Facet& facet = patches.facets[light.facet];
    WindowLight placed{light.facet, facet.material, lit_slots(animation, facet.material, frames), {}};
    for (PlacedRange range : placed_ranges(animation.objects[facet.object], frames)) {
      if (!narrow_to_lit(placed.lit, range.first_slot, range.last_slot)) continue;
      PlacedFacet at = place(facet, *range.pose);
      at.first_slot = range.first_slot;
      at.last_slot = range.last_slot;
      placed.poses.push_back({place_light(facet, at), roughness_of(at, facet.is_triangle)});
    }
    if (!placed.poses.empty()) lights.push_back(std::move(placed));
  }
  return lights;
}

}  // namespace engine
