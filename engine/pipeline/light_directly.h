// Direct light of every group of lights, as good as the job asks for, in steps that a killed run goes on
// from.
#pragma once

#include <span>
#include <vector>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/base/checkpoint.h"
#include "engine/lighting/compose.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {

/// Replicates of direct light and of lines that standard errors are told by, at least.
inline constexpr std::uint32_t kReplicatesMin = 8;

/// Samples that a target error may ask of a light, all passes together.
inline constexpr std::uint32_t kSamplesPerLightMax = 4096;

/// Are the standard errors of a job's light asked for, or needed?
inline bool wants_errors(const api::LightingOptions& options) {
  return options.standard_errors || options.target_error;
}

/// A job's samples, in replicates where errors are wanted.
DirectOptions direct_options(const api::LightingOptions& options, std::uint64_t seed);

/// Direct light of `groups` in `frames`; with a target error in as many passes as bring its part of the noise
/// below 1 / sqrt 2 of the target, as far as kSamplesPerLightMax allows. Errors: stopped.
api::Result<std::vector<LitGroup>> light_directly(const LitScene& lit, std::vector<LightGroup> groups,
                                                  std::span<const FrameIndex> frames,
                                                  const api::LightingOptions& options,
                                                  Checkpoints& checkpoints, StageClock& clock);

/// Area-weighted root mean square of the largest channel of a standard error, over the patches that never
/// emit [W/m^2].
double root_mean_square_error(const LitScene& lit, const PatchSeries& standard_error_w_m2);

}  // namespace engine
