// What the solution itself says of the key-frames that the estimate chose.
#pragma once

#include <span>
#include <vector>

#include "engine/keyframes/select_key_frames.h"
#include "engine/lighting/compose.h"
#include "engine/lighting/replicate_mean.h"

namespace engine {

/// What leaving check frames out would have done to the radiosity, B^ - B  [W/m^2], [patch]
/// [check]: Y (see solve_difference) interpolated from the keys alone, less Y as it was solved.
///
/// Where all light is interpolated it is B instead of Y.
///
/// keys, checks: increasing; of one window where it is interpolated by itself, else of the whole sequence.
/// interpolated: Y of each of `groups`, or parts of B that are interpolated one by one (`groups` empty),
/// [patch][position among keys and checks].
PatchSeries left_out(const LitScene& lit, std::span<const LitGroup> groups,
                     std::span<const PatchSeries* const> interpolated, std::span<const FrameIndex> keys,
                     std::span<const FrameIndex> checks, api::Interpolation interpolation);

/// What errors at the checks are relative to.
struct CheckedRadiosity {
  PatchSeries at_checks_w_m2;  ///< B, [patch][check]
  double mean_w_m2 = 0;        ///< mean B
};

/// Standard errors that B^ - B must exceed to count: the lines see a shadow's border move in steps, and what
/// few lines see of it is not the error of interpolating.
inline constexpr float kCheckSignificance = 5.0f;

/// Largest over the patches of what stands out of the noise, [check]:
///
///     e(i, f) = max_c (|m| - kCheckSignificance s) / max(max_c B, mean B / 2), at least 0
///
/// m: mean over the replicates of B^ - B. s: its standard error, or, where that is more, the root mean square
/// of those of the patches of its facet: of eight replicates some are close together by chance.
std::vector<double> check_errors(const LitScene& lit, const ReplicateMean& missed,
                                 const CheckedRadiosity& radiosity);

/// Makes all checks of an interval keys where one of them is `bad` (one flag per check), and gives the parts
/// checks of their own; not where the checks are all there is between its keys, since nothing would be
/// better. Returns whether anything changed. `chosen.solved` is brought up to date.
bool split(KeyFrames& chosen, const std::vector<bool>& bad);

}  // namespace engine
