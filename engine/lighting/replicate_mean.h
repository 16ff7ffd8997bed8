// Mean and scatter of independent replicates of one series.
#pragma once

#include "engine/lighting/radiosity.h"

namespace engine {

/// Follows the mean and the sum of squared deviations of replicates that come one after the other, part by
/// part. Source: Welford, "Note on a method for calculating corrected sums of squares and products", 1962.
class ReplicateMean {
 public:
  ReplicateMean(std::uint32_t patch_count, std::uint32_t frame_count)
      : mean_(patch_count, frame_count), squares_(patch_count, frame_count) {}

  /// Begins the next replicate.
  void begin() { ++count_; }
  /// Takes columns [skip, frame_count) of a part of it as frames from `first_frame` on, each frame once.
  void add(const PatchSeries& part, std::uint32_t skip, std::uint32_t first_frame);

  std::uint32_t count() const { return count_; }
  const PatchSeries& mean() const { return mean_; }
  /// Variance of the mean, sum (x_r - mean)^2 / (n (n - 1)), per channel; needs two replicates.
  PatchSeries variance() const;

  /// For checkpoints: what there is, as it is.
  PatchSeries& mean_values() { return mean_; }
  PatchSeries& squares() { return squares_; }
  const PatchSeries& squares() const { return squares_; }
  void set_count(std::uint32_t count) { count_ = count; }

 private:
  std::uint32_t count_ = 0;
  PatchSeries mean_, squares_;
};

}  // namespace engine
