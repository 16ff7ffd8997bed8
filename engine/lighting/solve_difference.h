// What moving objects and changing lights make of the scene at rest, in the frames that are solved.
#pragma once

#include <span>

#include "engine/lighting/gather.h"
#include "engine/lighting/rest_transport.h"
#include "engine/lighting/solve_at_rest.h"
#include "engine/lighting/sources.h"

namespace engine {

/// One window of frames as one set of lines sees it, lit by one group.
struct WindowScene {
  const LitScene& lit;
  std::span<const FrameIndex> frames;  ///< [slot], increasing
  const TracedLines& lines;            ///< traced for `frames`: M_f
  const RestTransport& transport;      ///< T_s
  const RestLight& rest;
  GroupSource source;
  double enough = kIterationError;  ///< what iterations may leave of B, relative to its mean
};

/// Light that differs from the scene at rest: X_f = X_s + D_f  [W/m^2], [patch][column]
struct DifferenceLight {
  PatchSeries irradiance_w_m2;  ///< D_f
  /// Y_f = T_s (rho_f D_f): what surfaces at rest send each other of D_f after it was reflected once more; 0
  /// of patches that move. It is smooth in time where D_f is not: what passes close by is in M_f, and the
  /// borders of shadows are in the source, which is known in every frame.
  PatchSeries carried_w_m2;
  Convergence convergence;
};

/// r_f where D_f is 0: s_f = S_f + rho_f X_s - R_s, [patch][column]. What lines carry differs by
/// r_f = R_f - R_s = s_f + rho_f D_f.
PatchSeries source_difference(const WindowScene& window, const Columns& columns);

/// Solves, in the slots of `columns`,
///
///     D_f = M_f (R_s + r_f) + T_s r_f,     r_f = S_f + rho_f (X_s + D_f) - R_s
///
/// with T_s of `window.transport` and M_f of `window.lines` (see SampledOperator). It is X_f = T_f R_f, less
/// X_s = T_s R_s: as X_s comes from more lines than the rest, the noise of the large, unchanging part of the
/// light is small. Source: perturbation of the static solution; iterated as solve_at_rest. Error: stopped.
/// carried: is Y wanted, or left empty?
enum class Carried { wanted, left_out };
api::Result<DifferenceLight> solve_difference(const WindowScene& window, const Columns& columns,
                                              const Progress& progress, Carried carried = Carried::wanted);

/// D_f in every slot of the window, from those that were solved (`columns`) and the interpolation of Y_f to
/// every slot, [patch][slot]:
///
///     D_f = M_f R_f + T_s s_f + Y_f
///
/// swept four times, from the solved D_f interpolated; in solved slots it is D_f again, within what the
/// iterations have left. So what moving objects cut, receive and send, and the
/// first bounce of what they change of the direct light, is gathered in every frame; interpolated is only
/// what surfaces at rest have reflected at least twice. Error: stopped.
api::Result<PatchSeries> fill_between(const WindowScene& window, const Columns& columns,
                                      const DifferenceLight& solved, api::Interpolation interpolation,
                                      const Progress& progress);

}  // namespace engine
