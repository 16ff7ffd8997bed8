// The patches of one window of frames, lit tile by tile.
#pragma once

#include <memory>

#include "engine/direct/tile_lighter.h"

namespace engine {

/// All calls are const and may run from many threads. What it refers to outlives it.
class WindowLighter {
 public:
  /// `frames`: 0 .. kWindowMax. `with_rest`: also finds the light of the scene at rest.
  WindowLighter(const Patches& patches, const Animation& animation, const Emission& emission,
                const StaticRays& static_rays, const StaticOccluders& static_occluders,
                std::span<const FrameIndex> frames, const DirectOptions& options, bool with_rest);
  WindowLighter(const WindowLighter&) = delete;
  WindowLighter& operator=(const WindowLighter&) = delete;

  /// Adds the irradiance of `cells` (bits) of a tile in `slots` to what `lighter` sums.
  void light_tile(const Tile& tile, const TileLayout& layout, std::uint64_t cells, Slots slots,
                  TileLighter& lighter) const;

  const LightingWindow& window() const { return window_; }

 private:
  const Patches& patches_;
  const Animation& animation_;
  const std::span<const FrameIndex> frames_;
  const WindowLights lights_;
  const std::unique_ptr<const MovingRays> moving_rays_;  ///< null where there are no frames
  const MovingOccluders moving_occluders_;
  const LightingWindow window_;
};

}  // namespace engine
