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
  double error_left = 0;         ///< bound on what further iterations would change of B, relative to its mean
  bool converged = true;         ///< error_left <= kIterationError
  std::uint64_t empty_rows = 0;  ///< patches and slots that no line met, given their polygon's mean
};

inline constexpr double kIterationError = 1e-5;
inline constexpr std::uint32_t kIterationsMax = 2000;

/// Solves B = S + rho T B for every slot of `lines` and returns what arrives, T B.
///
/// source_w_m2  S, [patch][slot]: exitance, or the direct light that is reflected      [W/m^2]
/// reflectance  rho, [patch], 0 <= rho < 1
///
/// Iterates B <- S + rho T B. If an iteration changes B by at most d, and by r d the one after, all that
/// follow change it by at most d r / (1 - r); it ends when that is below kIterationError of the mean of B, or
/// after kIterationsMax iterations (rho near 1): then `converged` is false and the light still grows. Changes
/// in the last place of a float are none. Error: stopped.
api::Result<Solution> solve_lighting(const Patches& patches, const TracedLines& lines,
                                     const std::vector<Rgb>& reflectance, const PatchSeries& source_w_m2,
                                     const Progress& progress);

}  // namespace engine
