// Every frame solved alone: what solving many at once is measured against.
#pragma once

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/base/checkpoint.h"
#include "engine/lighting/light_at_rest.h"
#include "engine/lighting/replicate_mean.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {

struct AloneLight {
  PatchSeries radiosity_w_m2;       ///< [patch][frame]
  PatchSeries standard_error_w_m2;  ///< the same; without values where no errors are asked for
  SolveCounts counts;
};

/// Takes each frame as a scene of its own in which nothing moves: its own rays, direct light, lines (the same
/// in each frame) and solution, by the same kernels as all other modes. Goes on after the frames that an
/// earlier run left in `checkpoints`. Error: stopped.
api::Result<AloneLight> light_frame_by_frame(const LitScene& lit, const api::LightingOptions& options,
                                             Checkpoints& checkpoints, StageClock& clock);

/// The scene of `frame` alone: one frame, in which all that is there rests.
Animation frozen(const Animation& animation, FrameIndex frame);

}  // namespace engine
