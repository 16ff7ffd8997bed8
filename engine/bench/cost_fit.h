// What solving k frames with N lines costs, after equations (1) and (2) of Besuievsky & Pueyo.
#pragma once

#include <span>

namespace engine {

/// One run: k frames solved, and the seconds that took.
struct CostPoint {
  double frames = 0;
  double seconds = 0;
};

/// Equation (2) gives the cost per frame; times k, and with log k taken as constant, it is a straight line:
///
///     C(k) = N (a + b k)                                                        [s]
///
/// a  what a line costs once: C1 log n_s + C3 n_is log n_is                      [s per line]
/// b  what it costs per frame, on the lines that meet the volume of the motion:
///    (2 A_d / A) (C3 n_id log n_id + C4 (n_is + n_id)), and here also what each frame's own light costs
struct CostFit {
  double once_s = 0;       ///< N a
  double per_frame_s = 0;  ///< N b
  double deviation = 0;    ///< root mean square of (measured - fitted) / measured  [-]

  double seconds(double frames) const { return once_s + per_frame_s * frames; }
  /// The most that solving fewer frames can ever gain: C(K) / (N a).
  double largest_speed_up(double all_frames) const;
};

/// Least squares. At least two points of different k; else all zero.
CostFit fit_cost(std::span<const CostPoint> points);

}  // namespace engine
