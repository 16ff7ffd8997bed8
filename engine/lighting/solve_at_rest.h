// The scene without what moves, solved once for all frames.
#pragma once

#include <cstdint>
#include <vector>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lighting/coarse_exchange.h"
#include "engine/lighting/radiosity.h"
#include "engine/lines/trace_lines.h"

namespace engine {

/// Iterations end when what further ones would change of B is below this, relative to its mean. A frame is
/// the sum of two solutions: B is within 5e-5 of its mean in all, with the rounding of sums; of patches far
/// brighter than the mean within 1e-5 of themselves. Lines bring it to that only in thousands of billions:
/// less would be iterations for nothing.
inline constexpr double kIterationError = 2e-5;
inline constexpr std::uint32_t kIterationsMax = 2000;

struct Convergence {
  std::uint32_t iterations = 0;
  double error_left = 0;  ///< bound on what further iterations would change of B, relative to its mean
  bool converged = true;  ///< error_left is little enough, or no more than rounding changes (convergence.h)
};

/// Light of the scene at rest, [patch]; 0 of patches that move.  [W/m^2]
struct RestLight {
  RgbValues irradiance_w_m2;  ///< X_s = T_s R_s: brought by lines
  RgbValues radiosity_w_m2;   ///< R_s = S + rho X_s: what lines carry on
  Convergence convergence;
};

/// Solves R = S + rho T_s R on `lines`, traced without frames.
/// coarse: of these lines and this reflectance.
/// source_w_m2  S, [patch]        reflectance  rho, [patch], 0 <= rho < 1
///
/// Iterates R <- S + rho T_s R. If an iteration changes R by at most d, and by r d the one after, all that
/// follow change it by at most d r / (1 - r). Changes in the last place of a float are none, and where
/// rounding is all that is left it ends. With rho near 1
/// it may end after kIterationsMax; then `converged` is false and the light still grows.
/// enough: the error_left to end at. Error: stopped.
api::Result<RestLight> solve_at_rest(const Patches& patches, const TracedLines& lines,
                                     const CoarseExchange& coarse, const std::vector<Rgb>& source_w_m2,
                                     const std::vector<Rgb>& reflectance, const Progress& progress,
                                     double enough = kIterationError);

}  // namespace engine
