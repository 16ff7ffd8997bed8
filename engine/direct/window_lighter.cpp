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

void WindowLighter::light_patch(PatchId patch, PatchLighter& lighter) const {
  for (const Receiver& receiver : place_receiver(patches_, animation_, patch, frames_))
    lighter.add_lights(receiver);
}

}  // namespace engine
