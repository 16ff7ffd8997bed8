// From patches to the radiosity of every frame: estimate, key-frames, direct light, solve, interpolate.
#pragma once

#include <vector>

#include "api/job_report.h"
#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/base/checkpoint.h"
#include "engine/lighting/lit_scene.h"
#include "engine/pipeline/named_series.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {

struct SolvedSequence {
  PatchSeries radiosity_w_m2;       ///< [patch][frame], every frame
  std::vector<NamedSeries> others;  ///< artefacts of their own: standard errors, groups of lights
  api::KeyFrameReport key_frames;
};

/// The file of the standard errors: those of the radiosity of every patch and frame, per channel, from
/// independent replicates of direct light and of lines (at least 8 of each, where there are as many samples).
/// Of frames that are interpolated whole (Interpolated::total) it is that of the values it is made of, as if
/// their noise were the same, which it nearly is; the error of interpolating is apart.
inline constexpr const char* kStandardErrorFile = "radiosity_se.npy";

/// That series, or null.
const PatchSeries* standard_error_of(const SolvedSequence& solved);

/// Runs the stages estimate .. interpolate as `options.mode` says. Adds its counts, its noise and its
/// warnings to `report`, and goes on from what an earlier run left in `checkpoints`, to the same bytes.
/// Errors: stopped; of the estimate's mesh out_of_resources and invalid_request, see mesh_into_patches (a run
/// has refused both before).
api::Result<SolvedSequence> solve_sequence(const LitScene& lit, const api::LightingOptions& options,
                                           StageClock& clock, api::JobReport& report,
                                           Checkpoints& checkpoints);
api::Result<SolvedSequence> solve_sequence(const LitScene& lit, const api::LightingOptions& options,
                                           StageClock& clock, api::JobReport& report);

}  // namespace engine
