#include "engine/estimate/replicates.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// Sum over the frames of the squared deviation of `row` from `centre`, less the deviation of their means.
double squares_in_time(const Rgb* row, const Rgb* centre, std::uint32_t frame_count) {
  Rgb mean;
  for (std::uint32_t f = 0; f < frame_count; ++f) mean += row[f] - centre[f];
  mean = mean * (1.0f / static_cast<float>(frame_count));
  double squares = 0;
  for (std::uint32_t f = 0; f < frame_count; ++f) {
    const Rgb off = row[f] - centre[f] - mean;
    squares += double{std::max({off.r * off.r, off.g * off.g, off.b * off.b})};
  }
  return squares;
}

}  // namespace

PatchSeries Replicates::mean() const {
  PatchSeries mean(all_[0].patch_count, all_[0].frame_count);
  for (const PatchSeries& replicate : all_)
    for (std::size_t k = 0; k < mean.values.size(); ++k) mean.values[k] += replicate.values[k];
  for (Rgb& value : mean.values) value = value * (1.0f / static_cast<float>(all_.size()));
  return mean;
}

std::vector<float> Replicates::noise_in_time(const PatchSeries& mean) const {
  const double count = static_cast<double>(all_.size());
  const double degrees = (count - 1) * std::max(1u, mean.frame_count - 1);
  std::vector<float> noise(mean.patch_count, 0.0f);
  for (PatchId patch = 0; patch < mean.patch_count; ++patch) {
    double squares = 0;
    for (const PatchSeries& replicate : all_)
      squares += squares_in_time(replicate.row(patch), mean.row(patch), mean.frame_count);
    noise[patch] = static_cast<float>(std::sqrt(squares / degrees / count));
  }
  return noise;
}

}  // namespace engine
