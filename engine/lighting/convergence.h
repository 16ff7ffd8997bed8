// When an iteration may end. Internal to engine/lighting.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/rgb.h"
#include "engine/lighting/solve_at_rest.h"

namespace engine {

/// Changes within the rounding of the value itself, two units in the last place, would go on for ever.
inline constexpr float kRoundingOfValue = 2.4e-7f;

/// Largest change of a channel that is more.
inline float largest_change(Rgb before, Rgb after) {
  const auto change = [](float b, float a) {
    const float by = std::abs(a - b);
    return by > kRoundingOfValue * std::abs(a) ? by : 0.0f;
  };
  return std::max({change(before.r, after.r), change(before.g, after.g), change(before.b, after.b)});
}

/// The same of rows of `count` values.
inline float largest_change(const Rgb* before, const Rgb* after, std::uint32_t count) {
  float change = 0;
  for (std::uint32_t c = 0; c < count; ++c) change = std::max(change, largest_change(before[c], after[c]));
  return change;
}

/// What changes are measured by: of what lines carry, over patches and frames.
struct Scale {
  double mean = 0;         ///< largest channel, area-weighted; 0: all is dark  [W/m^2]
  double largest = 0;      ///< [W/m^2]
  double reflectance = 0;  ///< the largest, rho
};

/// Follows the largest changes of the iterations. That rows of T_f sum to no more than 1 holds of what they
/// are samples of: T_s and M_f come from different lines, so single rows may have entries below 0 and sum to
/// more in absolute value. Such errors go up and down from patch to patch, and die out as others do: of n
/// crossings by n^-1/2.
class ConvergenceTest {
 public:
  /// enough: what may be left, relative to the mean.
  explicit ConvergenceTest(double enough = kIterationError) : enough_(enough) {}

  /// Takes the largest change of this iteration, and the largest correction that groups of patches say is
  /// then due (coarse_exchange.h): changes shrink by what iterations leave of the rest.
  void add(double change, double correction, const Scale& scale, Convergence& state) {
    const double mean = scale.mean;
    const double rho = std::min(scale.reflectance, kReflectanceMost);
    double left = change * rho / (1 - rho);  // no row of T_f sums to more than 1
    if (last_ > 0) {
      const double now = std::min(change / last_, kReflectanceMost);
      const double ratio = std::max({now, ratios_[0], ratios_[1]});
      if (state.iterations >= 2) left = std::min(left, correction + change * ratio / (1 - ratio));
      ratios_ = {ratios_[1], now};
    }
    state.error_left = mean > 0 ? left / mean : 0;
    if (!std::isfinite(change) || !std::isfinite(correction))
      state.error_left = std::numeric_limits<double>::infinity();
    state.converged = state.error_left <= enough_;
    last_ = change;
    if (change <= 0.5 * halved_from_) {
      halved_from_ = change;
      since_halved_ = 0;
    } else if (++since_halved_ > iterations_to_halve(scale.reflectance) &&
               change < kRoundingMax * scale.largest) {
      state.converged = true;
    }
    if (++state.iterations == 2) second_ = state.error_left;
  }

  bool may_end(const Convergence& state) const {
    return state.converged || state.iterations >= kIterationsMax;
  }

  /// The error shrinks by about the same factor each time, so its logarithm measures the way.
  double fraction(const Convergence& state) const {
    if (state.converged || second_ <= enough_) return 1.0;
    return std::clamp(std::log(second_ / state.error_left) / std::log(second_ / enough_), 0.0, 1.0);
  }

 private:
  /// No row of T sums to more than 1: without rounding the largest change falls by rho at least in every
  /// iteration. Two more, since the halves are not met exactly.
  static int iterations_to_halve(double reflectance) {
    const double rho = std::clamp(reflectance, 0.1, kReflectanceMost);
    return static_cast<int>(std::ceil(std::log(0.5) / std::log(rho))) + 2;
  }

  /// Changes this small that are not halved in that time are rounding, which in the sums of the brightest
  /// patches goes round in circles of some units in the last place, for ever; beside a mean that is far
  /// darker they can be more than is enough.
  static constexpr double kRoundingMax = 1e-5, kReflectanceMost = 0.9999;

  double enough_;
  double last_ = 0, second_ = 0, halved_from_ = std::numeric_limits<double>::infinity();
  int since_halved_ = 0;
  /// The two before: near the end changes are few units in the last place, and one ratio alone may be far too
  /// small by rounding. Until two are known the bound is that of the reflectance.
  std::array<double, 2> ratios_{0, 0};
};

}  // namespace engine
