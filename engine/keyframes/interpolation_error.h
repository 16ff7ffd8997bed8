// How far linear interpolation between two frames misses those between them.
#pragma once

#include <span>
#include <vector>

#include "engine/lighting/light_sequence.h"

namespace engine {

/// Standard errors that a difference must exceed to count: exceeded by chance once in 16,000 times, so rarely
/// among the hundreds of patches and frames that each interval is tested on.
inline constexpr float kSignificance = 4.0f;

/// The part of the radiosity that is interpolated, and what its error is measured against:
///
///     e(i, f) = max_c | B^ - B | / max(max_c B(i, f), mean B / 2)            [-]
///
/// mean B is area-weighted over the patches that do not emit, and over the frames. Where the noise of B is
/// known, only what stands out of it counts: from | B^ - B | are taken kSignificance standard errors of that
/// difference, sigma sqrt(1 + w^2 + (1-w)^2) where the frames are independent (w: weight of the later key).
/// An error that noise hides cannot be told from it, and a key-frame would not mend it.
class InterpolationError {
 public:
  /// radiosity: B;  interpolated: the part of it that is interpolated; both [patch][frame], kept by
  /// reference.
  /// noise: standard error of `interpolated` in a frame, [patch]; empty: none.
  InterpolationError(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                     const PatchSeries& interpolated_w_m2, std::vector<float> noise_w_m2 = {});

  std::uint32_t frame_count() const { return interpolated_.frame_count; }

  /// e of frame `f` from the frames `a` < f < `b`, largest over the patches.
  double at(api::FrameIndex a, api::FrameIndex f, api::FrameIndex b) const;

  /// The same where `a`, `f`, `b` are positions of frames that are not evenly spaced; `weight` is that of
  /// `b`.
  double left_out(api::FrameIndex a, api::FrameIndex f, api::FrameIndex b, float weight) const;

  /// Is e <= `tolerance` for every patch and frame between `a` and `b`? Quick where it is not: patches that
  /// refused before are asked first.
  bool within(api::FrameIndex a, api::FrameIndex b, double tolerance);

  /// Largest e over the frames between `a` and `b`; 0 where there are none.
  double largest(api::FrameIndex a, api::FrameIndex b) const;

 private:
  float of_patch(PatchId patch, api::FrameIndex a, api::FrameIndex f, api::FrameIndex b, float weight) const;

  const PatchSeries& interpolated_;
  std::vector<float> noise_;            ///< [patch], or empty
  std::vector<float> scale_;            ///< 1 / max(max_c B, mean B / 2), [patch][frame]
  std::vector<PatchId> refused_first_;  ///< all patches, those that refused lately in front
};

}  // namespace engine
