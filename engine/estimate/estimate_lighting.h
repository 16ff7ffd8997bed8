// A coarse and quick look at the lighting of every frame, to choose the key-frames by.
#pragma once

#include <vector>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lighting/light_sequence.h"

namespace engine {

/// Lighting of every frame on large patches.
struct Estimate {
  Patches patches;
  PatchSeries radiosity_w_m2;  ///< B, [patch][frame]; 0 where the object is not there
  PatchSeries indirect_w_m2;   ///< the part of B that global lines brought: rho times indirect irradiance
  /// Standard error of the part of indirect_w_m2 that varies over the frames, largest channel, [patch]: from
  /// kReplicates independent sets of lines. What is common to all frames moves no key-frame and is left out.
  std::vector<float> noise_w_m2;
};

/// Independent scrambles that the estimate's lines are divided into, to tell noise from light.
inline constexpr std::uint32_t kReplicates = 4;

/// Solves all frames on patches of `options.estimate_patch_edge_m` with `options.estimate_line_count` lines
/// in kReplicates independent parts, and takes their mean. `static_rays` may be those of finer patches of the
/// same scene: the facets are the same. Source: Besuievsky & Pueyo, 2001, section 5.
/// Errors: stopped; out_of_resources and invalid_request as mesh_into_patches says.
api::Result<Estimate> estimate_lighting(const Scene& scene, const Animation& animation,
                                        const StaticRays& static_rays, const api::LightingOptions& options,
                                        const Progress& progress);

}  // namespace engine
