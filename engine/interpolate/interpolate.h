// In-between frames from key-frames, per patch, in object space.
#pragma once

#include <span>

#include "engine/lighting/radiosity.h"

namespace engine {

/// Where a frame lies between two solved ones: weight of the later one, 0 .. 1.
struct Between {
  std::uint32_t before = 0, after = 0;  ///< positions in the list of solved frames
  float weight = 0;                     ///< 0 at `before`, 1 at `after`
};

/// `frame` between `solved` (increasing, not empty); before the first and after the last it is held.
Between between(std::span<const api::FrameIndex> solved, api::FrameIndex frame);

/// Linear interpolation of [patch][solved frame] to [patch][frame], for frames 0 .. frame_count - 1.
PatchSeries interpolate_linear(const PatchSeries& at_solved, std::span<const api::FrameIndex> solved,
                               std::uint32_t frame_count);

}  // namespace engine
