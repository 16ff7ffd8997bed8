// B = S + rho T B by iteration on the sampled operator.
#pragma once

#include <cstdint>
#include <vector>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lighting/gather.h"
#include "engine/lighting/radiosity.h"

namespace engine {

struct Solution {
  PatchSeries irradiance_w_m2;  ///< T B of the solution, [patch][slot]
  std::uint32_t iterations = 0;
  double last_change = 0;        ///< largest change of B in the last iteration, relative to the mean of |S|
  std::uint64_t empty_rows = 0;  ///< patches and slots that no line met, given their polygon's mean
};

/// Solves B = S + rho T B for every slot of `lines` and returns what arrives, T B.
///
/// source_w_m2  S, [patch][slot]: exitance, or the direct light that is reflected      [W/m^2]
/// reflectance  rho, [patch], 0 <= rho < 1
///
/// Iterates B <- S + rho T B until no channel of any patch changes by more than 1e-5 of the mean source; what
/// is left then is below 1e-5 rho / (1 - rho) of it, for the largest rho. At most 500 times.
/// Error: stopped.
api::Result<Solution> solve_lighting(const Patches& patches, const TracedLines& lines,
                                     const std::vector<Rgb>& reflectance, const PatchSeries& source_w_m2,
                                     const Progress& progress);

}  // namespace engine
