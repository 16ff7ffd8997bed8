// What the solution itself says of the key-frames that the estimate chose.
#pragma once

#include <span>
#include <vector>

#include "engine/keyframes/select_key_frames.h"
#include "engine/lighting/compose.h"
#include "engine/lighting/replicate_mean.h"

namespace engine {

/// What leaving the check frames of a window out would have done to the radiosity, B^ - B  [W/m^2], [patch]
/// [check]: Y (see solve_difference) interpolated from the keys alone, less Y as it was solved.
///
/// Where all light is interpolated it is B instead of Y.
///
/// keys, checks: frames of the window, increasing.  interpolated: Y of each of `groups`, or B alone (`groups`
/// empty), [patch][position among keys and checks].
PatchSeries left_out(const LitScene& lit, std::span<const LitGroup> groups,
                     std::span<const PatchSeries* const> interpolated, std::span<const FrameIndex> keys,
                     std::span<const FrameIndex> checks, api::Interpolation interpolation);

/// Largest e(i, f) = max_c |missed| / max(max_c B, floor) over the patches, [check].
/// missed, radiosity: [patch][check]; floor_w_m2: half the mean B.
std::vector<double> largest_errors(const PatchSeries& missed, const PatchSeries& radiosity_w_m2,
                                   double floor_w_m2);

/// Makes the checks of `bad` (one flag per check) keys, with a check in the middle of each half that has one.
/// Returns whether anything changed. `chosen.solved` is brought up to date.
bool split(KeyFrames& chosen, const std::vector<bool>& bad);

}  // namespace engine
