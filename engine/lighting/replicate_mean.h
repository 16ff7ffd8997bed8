// Mean and scatter of independent replicates of one series.
#pragma once

#include "engine/lighting/radiosity.h"

namespace engine {

/// Follows the mean and the sum of squared deviations of replicates that come one after the other, part by
/// part. Source: Welford, "Note on a method for calculating corrected sums of squares and products", 1962.
class ReplicateMean {
 public:
  ReplicateMean(std::uint32_t patch_count, std::uint32_t frame_count)
      : patch_count_(patch_count), frame_count_(frame_count) {}

  /// Begins the next replicate.
  void begin() { ++count_; }
  /// Takes columns [skip, frame_count) of a part of it as frames from `first_frame` on, each frame once.
  void add(PatchSeries part, std::uint32_t skip, std::uint32_t first_frame);

  std::uint32_t count() const { return count_; }
  /// Empty before the first.
  const PatchSeries& mean() const { return mean_; }
  PatchSeries take_mean() { return std::move(mean_); }
  /// Variance of the mean, sum (x_r - mean)^2 / (n (n - 1)), per channel; needs two replicates.
  PatchSeries variance() const;

  /// For checkpoints: what there is, as it is.
  PatchSeries& mean_values() { return with_room(mean_); }
  PatchSeries& squares() { return with_room(squares_); }
  const PatchSeries& squares() const { return squares_; }
  void set_count(std::uint32_t count) { count_ = count; }

 private:
  PatchSeries& with_room(PatchSeries& series) const {
    if (series.values.empty()) series = PatchSeries(patch_count_, frame_count_);
    return series;
  }

  std::uint32_t patch_count_, frame_count_;
  std::uint32_t count_ = 0;
  PatchSeries mean_, squares_;  ///< squares_: empty until there are two
};

}  // namespace engine
