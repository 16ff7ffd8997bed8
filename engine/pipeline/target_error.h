// Is the light as good as a job asks, and what would make it so?
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/lighting/compose.h"
#include "engine/lighting/replicate_mean.h"

namespace engine {

/// Noise of a solution relative to mean B, see root_mean_square_error.  [-]
struct Noise {
  double whole = 0;
  double of_lines = 0;  ///< without that of the direct light which is added to what lines bring
};

/// `arriving`: indirect irradiance of all groups, [patch][position in `frames`], two replicates at least.
Noise noise_of(const LitScene& lit, const std::vector<LitGroup>& groups, std::span<const FrameIndex> frames,
               const ReplicateMean& arriving);

/// What so many replicates came to.
struct LinesSpent {
  std::uint32_t replicates = 0;
  Noise noise;
};

/// Replicates that should bring the noise below `target` (an error relative to mean B), a little more than
/// needed; not above `now.replicates` where it is met, or where more lines would not help.
///
/// The squared noise is a + b / n of n replicates: lines carry the noise of the direct light too, which more
/// of them do not reduce. `before`, of fewer replicates, tells a; without it (0 replicates) it is the direct
/// light's own.
std::uint32_t replicates_for(double target, const LinesSpent& before, const LinesSpent& now);

}  // namespace engine
