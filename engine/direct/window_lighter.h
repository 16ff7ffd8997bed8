// The patches of one window of frames, lit one by one.
#pragma once

#include <memory>

#include "engine/direct/arrival.h"
#include "engine/direct/direct_light.h"
#include "engine/direct/patch_sums.h"

namespace engine {

/// All calls are const and may run from many threads. What it refers to outlives it.
class WindowLighter {
 public:
  /// `frames`: 0 .. kWindowMax. `with_rest`: also finds the light of the scene at rest.
  WindowLighter(const Patches& patches, const Animation& animation, const Emission& emission,
                const StaticRays& static_rays, std::span<const FrameIndex> frames,
                const DirectOptions& options, bool with_rest);

  /// Adds the irradiance of `patch` to `sums`. Answers the number of shadow rays.
  std::uint64_t light_patch(PatchId patch, PatchSums& sums) const;

 private:
  class Work;
  struct SampleSet;

  const Patches& patches_;
  const Animation& animation_;
  const StaticRays& static_rays_;
  const std::span<const FrameIndex> frames_;
  const DirectOptions options_;
  const bool with_rest_;
  const float reach_m_;
  const WindowLights lights_;
  std::unique_ptr<const MovingRays> moving_rays_;  ///< null where there are no frames
};

}  // namespace engine
