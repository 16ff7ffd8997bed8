// Independent estimates of one thing: their mean, and how far they scatter.
#pragma once

#include <vector>

#include "engine/lighting/radiosity.h"

namespace engine {

/// Two or more replicates of one series, from independent random numbers.
class Replicates {
 public:
  void add(PatchSeries replicate) { all_.push_back(std::move(replicate)); }

  PatchSeries mean() const;

  /// Standard error in time of `mean`, which is mean(), largest channel, [patch]: the deviations of the
  /// replicates from it, each less its own mean over the frames, pooled over the frames. What is common to
  /// all frames is left out.
  std::vector<float> noise_in_time(const PatchSeries& mean) const;

 private:
  std::vector<PatchSeries> all_;
};

}  // namespace engine
