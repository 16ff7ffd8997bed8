// The lighting of chosen frames: direct light apart or not, global lines, solution, window by window.
#pragma once

#include <span>
#include <vector>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/base/progress.h"
#include "engine/lighting/radiosity.h"
#include "engine/lines/trace_lines.h"
#include "engine/scene/scene.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// What a solve needs besides its options; all of it outlives the call.
struct LitScene {
  const Scene& scene;
  const Animation& animation;
  const Patches& patches;
  const StaticRays& static_rays;
};

/// rho of every patch, [patch].
std::vector<Rgb> reflectance_of_patches(const Scene& scene, const Patches& patches);

/// Exitance of a patch in a frame  [W/m^2]: of fronts only.
Rgb exitance_of_patch(const LitScene& lit, PatchId patch, FrameIndex frame);

/// Over all windows; what is static is the same in each and counted once.
/// Over all windows; what is static is the same in each and counted once.
struct SolveCounts {
  TracingCounts tracing;               ///< touched_lines: of the window that has most
  std::uint64_t exchanges = 0;         ///< of the static scene
  std::uint64_t moving_exchanges = 0;  ///< that moving objects add or cut
  std::uint64_t empty_rows = 0;        ///< patches and frames
  std::uint32_t iterations = 0;        ///< of the window that took most
  bool converged = true;               ///< in every window, see solve_lighting
};

struct IndirectLight {
  PatchSeries irradiance_w_m2;  ///< arriving other than directly, [patch][position in `frames`]
  SolveCounts counts;
};

/// Frames solved at once: bounds the memory that the moving exchanges take.
inline constexpr std::size_t kSolveWindow = 64;

/// Irradiance that global lines carry, in each of `frames` (increasing): all but the direct light. With
/// `direct` null (DirectLight::pure) the exitance itself travels by lines and the result is everything that
/// arrives.
/// direct  irradiance from the lights, [patch][position in `frames`], or null       [W/m^2]
/// Error: stopped.
api::Result<IndirectLight> indirect_light(const LitScene& lit, std::span<const FrameIndex> frames,
                                          const PatchSeries* direct, const LineOptions& options,
                                          const Progress& progress);

}  // namespace engine
