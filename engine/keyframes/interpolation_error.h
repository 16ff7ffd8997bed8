// How far linear interpolation between two frames misses those between them.
#pragma once

#include <span>
#include <vector>

#include "engine/lighting/light_sequence.h"

namespace engine {

/// The part of the radiosity that is interpolated, and what its error is measured against:
///
///     e(i, f) = max_c | B^ - B | / max(max_c B(i, f), mean B / 2)            [-]
///
/// mean B is area-weighted over the patches that do not emit, and over the frames.
class InterpolationError {
 public:
  /// radiosity: B;  interpolated: the part of it that is interpolated; both [patch][frame], kept by
  /// reference.
  InterpolationError(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                     const PatchSeries& interpolated_w_m2);

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
  std::vector<float> scale_;            ///< 1 / max(max_c B, mean B / 2), [patch][frame]
  std::vector<PatchId> refused_first_;  ///< all patches, those that refused lately in front
};

}  // namespace engine
