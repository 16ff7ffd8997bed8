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
  /// Standard deviations of `direct` in a frame that are added to it there, [patch]; or empty. See
  /// noise_of_direct.
  std::span<const float> noise = {};

  std::uint32_t column(FrameIndex frame) const { return position.empty() ? frame : position[frame]; }
  /// Irradiance from the lights; needs `direct`  [W/m^2]
  Rgb direct_in_frame(PatchId patch, FrameIndex frame) const {
    return direct->irradiance_w_m2.at(patch, column(frame));
  }
  /// S of B = S + rho T B in `frame`  [W/m^2]
  Rgb in_frame(const LitScene& lit, PatchId patch, FrameIndex frame) const;
};

/// Noise of direct light for a replicate, [patch], in standard deviations of the mean direct light in a
/// frame; empty where these are not known:
///
///     eta_i,r(f) = sqrt(R c_b v_i(f)) (z_i,r - mean_r z_i,r)                 [W/m^2]
///
/// R is `replicates`; replicates from R on begin the next block of R, over each of which the noise adds up to
/// 0. c_b = ((2 b + 1) R - 1) / (R - 1) in block b = 0, 1, ..: then the squares of b + 1 blocks add up to
/// what gives the variance v_i to the mean of all of them, however many there will be. z are independent
/// standard normals, the same for all channels and frames: samples are shared by the frames. v is the
/// variance of the mean direct light. The scene at rest has none of it, so that a frame is the same whatever
/// frames are lit beside it.
///
/// Why: the replicates of lines share one direct light, so what its noise does to the light that is reflected
/// would not be seen in their scatter. The noise of all replicates adds up to 0, light is linear, so their
/// mean is what it would be without it but for what lines make of it; and its scatter over the replicates has
/// the variance v_i in the mean. seed: of the job. group: position among the groups of lights; independent
/// for each.
std::vector<float> noise_of_direct(const DirectLight& direct, std::uint32_t replicate,
                                   std::uint32_t replicates, std::uint64_t seed, std::size_t group);

/// S of the scene at rest, [patch]: with the mean over all frames of what emits and reflects; 0 of patches
/// that move.
std::vector<Rgb> source_at_rest(const LitScene& lit, const GroupSource& source,
                                std::span<const Rgb> reflectance_at_rest);

}  // namespace engine
