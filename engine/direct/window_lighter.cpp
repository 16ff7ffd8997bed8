#include "engine/direct/window_lighter.h"

#include "engine/direct/scene_reach.h"

namespace engine {

WindowLighter::WindowLighter(const Patches& patches, const Animation& animation, const Emission& emission,
                             const StaticRays& static_rays, const StaticOccluders& static_occluders,
                             std::span<const FrameIndex> frames, const DirectOptions& options, bool with_rest)
    : patches_(patches),
      animation_(animation),
      frames_(frames),
      lights_(place_window_lights(patches, animation, emission, frames)),
      moving_rays_(frames.empty() ? nullptr : new MovingRays(patches, animation, frames)),
      moving_occluders_(patches, animation, frames),
      window_{&static_rays,
              moving_rays_.get(),
              &static_occluders,
              &moving_occluders_,
              &lights_,
              options,
              scene_reach_m(patches, animation),
              with_rest} {}

void WindowLighter::light_tile(const Tile& tile, const TileLayout& layout, std::uint64_t cells, Slots slots,
                               TileLighter& lighter) const {
  const ObjectMotion& motion = animation_.objects[patches_.facets[tile.facet].object];
  PlacedTile placed;
  if (motion.is_static(animation_.frame_count)) {
    placed.place(patches_, tile, layout, motion.spans[0].pose, slots, true);
    return lighter.light(placed, cells);
  }
  for (const PlacedRange& range : placed_ranges(motion, frames_)) {
    const Slots there = overlap(slots, {range.first_slot, range.last_slot + 1});
    if (there.empty()) continue;
    placed.place(patches_, tile, layout, *range.pose, there, false);
    lighter.light(placed, cells);
  }
}

}  // namespace engine
