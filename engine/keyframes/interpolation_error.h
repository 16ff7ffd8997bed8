// How far interpolation between two frames misses those between them, on the estimate.
#pragma once

#include <span>
#include <vector>

#include "api/lighting_options.h"
#include "engine/estimate/estimate.h"
#include "engine/lighting/lit_scene.h"

namespace engine {

/// What the replicates of the estimate say of an error and a tolerance.
enum class Evidence {
  likely,  ///< the mean of the replicates
  surely,  ///< the mean and kSignificance standard errors more
  hardly,  ///< the mean and kSignificance standard errors less
};

/// Student's t of 7 degrees of freedom is above it by chance in 1 of 330 cases.
inline constexpr float kSignificance = 3.9f;

/// Error of the radiosity where what `Estimate::interpolated` holds is interpolated:
///
///     e(i, f) = max_c | B^ - B | / max(max_c B(i, f), mean B / 2)            [-]
///     B^ - B = rho_i(f) sum_g scale_g(f) (Y^_g - Y_g)
///
/// mean B is area-weighted over the patches that do not emit, and over the frames. The replicates trace the
/// same lines in every frame, so what noise is common to frames cancels in Y^ - Y of each, and the scatter of
/// Y^ - Y over the replicates is its noise: a paired comparison.
class InterpolationError {
 public:
  /// `estimate`, which has what mode `default` compares, outlives it and does not change.
  InterpolationError(const LitScene& lit, const Estimate& estimate, api::Interpolated what);
  InterpolationError(const LitScene& lit, Estimate&& estimate, api::Interpolated what) = delete;

  std::uint32_t frame_count() const { return frame_count_; }

  /// Is e <= `tolerance` for every patch and frame between `a` and `b`, interpolated linearly? Quick where it
  /// is not: patches that refused before are asked first.
  bool within(api::FrameIndex a, api::FrameIndex b, double tolerance, Evidence evidence);

  /// The same of those patches alone that `within` has found to refuse some interval: quick, and true
  /// wherever `within` is.
  bool seems_within(api::FrameIndex a, api::FrameIndex b, double tolerance, Evidence evidence);

  /// Largest e over the patches, [frame], interpolated from `knots` (increasing, first and last frame
  /// included); by the mean of the replicates. As the solution interpolates: all light over the whole
  /// sequence (of named groups each by itself, where this has the cubic of their sum); indirect light window
  /// by window (shared_frames, which are knots then), so that a cubic has slopes of its own at the ends of
  /// each.
  std::vector<double> largest(std::span<const api::FrameIndex> knots, api::Interpolation interpolation) const;

 private:
  /// Is some frame between missed by more? Patches refused_first_[first, end) are asked.
  bool refuses(std::size_t first, std::size_t end, api::FrameIndex a, api::FrameIndex b, double tolerance,
               Evidence evidence);
  float of_patch(PatchId patch, api::FrameIndex a, api::FrameIndex f, api::FrameIndex b,
                 Evidence evidence) const;

  const ReplicateSeries& values_;
  std::uint32_t frame_count_, group_count_;
  std::vector<api::FrameIndex> ends_;   ///< of what is interpolated in one go
  std::vector<Rgb> weights_;            ///< rho scale, [patch][frame][group]
  std::vector<float> relative_;         ///< 1 / max(max_c B, mean B / 2), [patch][frame]
  std::vector<PatchId> refused_first_;  ///< all patches, those that refused lately in front
  std::size_t refusing_ = 0;            ///< of these, those that ever refused
};

}  // namespace engine
