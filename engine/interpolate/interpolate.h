// In-between frames from key-frames, per patch, in object space.
#pragma once

#include <span>
#include <vector>

#include "api/lighting_options.h"
#include "engine/lighting/radiosity.h"

namespace engine {

/// Interpolates rows of values at `knots` to other frames. Before the first and after the last knot the value
/// is held.
///
/// linear          between two knots a < f < b with w = (f - a) / (b - a):  (1 - w) x_a + w x_b
/// monotone cubic  cubic Hermite with the slopes of Fritsch & Butland: 0 where the secants d_k-1, d_k on both
///                 sides differ in sign, else their harmonic mean weighted by the lengths h of the intervals,
///                 (w1 + w2) / (w1 / d_k-1 + w2 / d_k), w1 = 2 h_k + h_k-1, w2 = h_k + 2 h_k-1; at the ends
///                 the parabola through three knots, limited so that nothing overshoots. Every channel by
///                 itself.
/// Sources: Fritsch & Carlson, SIAM J. Numer. Anal. 17(2), 1980; Fritsch & Butland, SIAM J. Sci. Stat.
/// Comput. 5(2), 1984.
class Interpolator {
 public:
  /// knots: increasing, not empty.  frames: those wanted, increasing.
  Interpolator(std::span<const api::FrameIndex> knots, std::span<const api::FrameIndex> frames,
               api::Interpolation kind);

  std::uint32_t knot_count() const { return static_cast<std::uint32_t>(knots_.size()); }
  std::uint32_t frame_count() const { return static_cast<std::uint32_t>(places_.size()); }

  /// at_knots: knot_count() values; to: frame_count() values. At a knot exactly its value.
  void apply(const Rgb* at_knots, Rgb* to) const;

 private:
  /// Where a frame lies.
  struct Place {
    std::uint32_t before = 0, after = 0;  ///< knots
    float weight = 0;                     ///< 0 at `before`, 1 at `after`
  };

  void apply_cubic(const Rgb* at_knots, Rgb* to) const;

  std::vector<api::FrameIndex> knots_;
  std::vector<Place> places_;
  api::Interpolation kind_;
};

/// [patch][knot] to [patch][frame].
PatchSeries interpolate(const PatchSeries& at_knots, const Interpolator& interpolator);

}  // namespace engine
