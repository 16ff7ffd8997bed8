// Irradiance straight from the lights, in every frame.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lighting/radiosity.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

struct DirectOptions {
  /// Rays of a patch against each light where something may be in the way, all replicates together; where
  /// nothing is, none are needed. Sixteen are cast at once: fewer save little. 32 times as many per patch at
  /// most, unless lights take turns or move.  1 .. 1024
  std::uint32_t samples_per_light = 16;
  /// Independent sets that the samples are dealt out to, each with max(1, samples / replicates) of them;
  /// their scatter is the variance. 1: none is known.  1 .. 1024
  std::uint32_t replicates = 1;
  std::uint64_t seed = 1;
};

/// What it took.
struct DirectCounts {
  /// Points of patches against lights, each once for all frames, that results stand for
  std::uint64_t light_samples = 0;
  std::uint64_t shadow_rays = 0;  ///< for those where something may have been in the way

  DirectCounts& operator+=(const DirectCounts& more) {
    light_samples += more.light_samples;
    shadow_rays += more.shadow_rays;
    return *this;
  }
};

/// [patch][position in `frames`]
struct DirectLight {
  PatchSeries irradiance_w_m2;  ///< mean of the replicates
  /// Of that mean, per channel: sum_r (x_r - mean)^2 / (R (R - 1)), with x_r all the light of a patch in
  /// replicate r; without values where there is one replicate only  [(W/m^2)^2]
  PatchSeries variance;
  /// [patch]: of the scene without anything that moves: patches at rest lit by lights at rest past occluders
  /// at rest, each light as bright as in the mean of all frames of the animation; 0 for patches that move. It
  /// does not depend on `frames`.  [W/m^2]
  std::vector<Rgb> at_rest_w_m2;
  DirectCounts counts;
};

/// Lights patches in each of `frames` (increasing; none: only what is at rest).
///
/// Per patch and light, over `samples_per_light` points x_s of the patch and y_s of the light:
///
///     H = E F (1 - sum_s w_s b_s / sum_s w_s)
///
/// F is the mean over the patch of the closed form factor to the light; of a light without surface, of
/// cos / r^2, or cos (arrival.h). Where the light is away from the patch by some times its size, F comes from
/// a fixed rule, exact to 1e-4 or so (kApartRadii, TileView: it depends on where the two are and on nothing
/// else); else from the points x_s. b_s in {0, 1} tells whether the ray from x_s to y_s is blocked, a hair
/// off the surfaces at both ends (clearance_m); w_s is what it would carry by what it was likely to be drawn
/// (join). So H has no noise where nothing is hidden, and is exactly 0 where everything is; as a ratio it is
/// off by less than the scatter of w times that of b by the number of points, which their densities, bilinear
/// on patch and light, keep small. Rays are cast only where something can stand between (shaft.h), found for
/// neighbouring patches together (TileLighter). Static surfaces answer once for all frames, moving ones say
/// in which frames they block. The same points in every frame: what noise there is does not flicker. Patches
/// of an object that is not there in a frame get 0.
///
/// Where more than 32 lights can shine on a patch, those that matter most are sampled so, and the others
/// share samples that are drawn among them: about twice those of 15 lights, for any number (light_choice.h).
///
/// `emission` says what shines: all of animation.emission, or a part of it. The arguments outlive the
/// lighter.
class DirectLighter {
 public:
  DirectLighter(const Patches& patches, const Animation& animation, const Emission& emission,
                const StaticRays& static_rays, std::span<const FrameIndex> frames,
                const DirectOptions& options);
  ~DirectLighter();
  DirectLighter(const DirectLighter&) = delete;
  DirectLighter& operator=(const DirectLighter&) = delete;

  /// Room for the result, all zero.
  DirectLight empty() const;

  /// Lights patches [first, end) in all frames; writes only their rows, and adds to `counts`. What a
  /// patch gets does not depend on the range it is lit in. With more than kWindowMax frames every call builds
  /// the windows anew: worth it for calls that take seconds. One call at a time.
  /// Error: stopped; then the rows of the range are unfinished.
  api::Status light(PatchId first, PatchId end, DirectLight& into, const Progress& progress) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// All patches at once. Error: stopped.
api::Result<DirectLight> direct_light(const Patches& patches, const Animation& animation,
                                      const Emission& emission, const StaticRays& static_rays,
                                      std::span<const FrameIndex> frames, const DirectOptions& options,
                                      const Progress& progress);

}  // namespace engine
