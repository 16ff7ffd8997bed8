// Irradiance straight from the lights, in every frame.
#pragma once

#include <cstdint>
#include <span>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lighting/radiosity.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

struct DirectOptions {
  std::uint32_t samples_per_light = 16;  ///< shadow rays per patch and light  [rays] 1 .. 1024
  std::uint64_t seed = 1;
};

/// Irradiance of every patch from the emitting facets, in each of `frames` (increasing)  [W/m^2],
/// [patch][position in `frames`].
///
/// Per patch and light, over `samples_per_light` points x of the patch and y of the light:
///
///     H = E mean_s F(x_s) V(x_s, y_s)
///
/// F is the closed form factor from x to the light, so that an unobstructed light has no noise but that of x;
/// V is a shadow ray, a hair off the surfaces at both ends (clearance_m). Static surfaces answer once for all
/// frames, moving ones with one query that says in which frames they block. The same points in every frame:
/// what noise there is does not flicker. y is chosen nearly in proportion to its contribution (sample_light).
/// Patches of an object that is not there in a frame get 0.
/// Error: stopped.
api::Result<PatchSeries> direct_light(const Patches& patches, const Animation& animation,
                                      const StaticRays& static_rays, std::span<const FrameIndex> frames,
                                      const DirectOptions& options, const Progress& progress);

}  // namespace engine
