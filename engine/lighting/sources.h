// Where the light that lines carry comes from: what is emitted, or reflected of the direct light.
#pragma once

#include <span>
#include <vector>

#include "engine/direct/direct_light.h"
#include "engine/lighting/lit_scene.h"
#include "engine/lighting/radiosity.h"

namespace engine {

/// One group's light before the first line.
struct GroupSource {
  const Emission* emission = nullptr;
  /// [patch][frame of the animation] and at rest, or null: then the exitance itself travels by lines.
  const DirectLight* direct = nullptr;
  /// Position of a frame in `direct`: that of frame f is position[f]. Empty: it is f itself.
  std::span<const std::uint32_t> position = {};

  /// Irradiance from the lights; needs `direct`  [W/m^2]
  Rgb direct_in_frame(PatchId patch, FrameIndex frame) const {
    return direct->irradiance_w_m2.at(patch, position.empty() ? frame : position[frame]);
  }
  /// S of B = S + rho T B in `frame`  [W/m^2]
  Rgb in_frame(const LitScene& lit, PatchId patch, FrameIndex frame) const;
};

/// S of the scene at rest, [patch]: with the mean over all frames of what emits and reflects; 0 of patches
/// that move.
std::vector<Rgb> source_at_rest(const LitScene& lit, const GroupSource& source,
                                std::span<const Rgb> reflectance_at_rest);

}  // namespace engine
