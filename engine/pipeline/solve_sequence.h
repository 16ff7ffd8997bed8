// From patches to the radiosity of every frame: estimate, key-frames, direct light, solve, interpolate.
#pragma once

#include "api/job_report.h"
#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/lighting/light_sequence.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {

struct SolvedSequence {
  PatchSeries radiosity_w_m2;  ///< [patch][frame], every frame
  api::KeyFrameReport key_frames;
};

/// Runs the stages estimate .. interpolate as `options.mode` says. Adds its counts to `report`.
/// Errors: stopped; of the estimate's mesh out_of_resources and invalid_request, see mesh_into_patches (a run
/// has refused both before).
api::Result<SolvedSequence> solve_sequence(const LitScene& lit, const api::LightingOptions& options,
                                           StageClock& clock, api::JobReport& report);

}  // namespace engine
