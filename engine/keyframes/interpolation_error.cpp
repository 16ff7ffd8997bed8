#include "engine/keyframes/interpolation_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace engine {
namespace {

/// Area-weighted mean of the largest channel of B over the patches that emit in no frame.
double mean_radiosity(const LitScene& lit, const PatchSeries& radiosity) {
  std::vector<bool> emits;  // [material]
  for (std::uint32_t m = 0; m < lit.animation.emission.exitance_w_m2.size(); ++m)
    emits.push_back(lit.animation.emission.ever_emits(m));
  double sum = 0, area = 0;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (emits[lit.patches.facets[lit.patches.facet_of[patch]].material] && !lit.patches.is_back(patch))
      continue;
    for (std::uint32_t frame = 0; frame < radiosity.frame_count; ++frame)
      sum += double{lit.patches.area_m2[patch]} * max_channel(radiosity.at(patch, frame));
    area += double{lit.patches.area_m2[patch]} * radiosity.frame_count;
  }
  return area > 0 ? sum / area : 0;
}

float weight_of(api::FrameIndex a, api::FrameIndex f, api::FrameIndex b) {
  return static_cast<float>(f - a) / static_cast<float>(b - a);
}

}  // namespace

InterpolationError::InterpolationError(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                                       const PatchSeries& interpolated_w_m2, std::vector<float> noise_w_m2)
    : interpolated_(interpolated_w_m2),
      noise_(std::move(noise_w_m2)),
      scale_(radiosity_w_m2.values.size()),
      refused_first_(lit.patches.count()) {
  const auto floor = static_cast<float>(0.5 * mean_radiosity(lit, radiosity_w_m2));
  for (std::size_t k = 0; k < scale_.size(); ++k) {
    const float against = std::max(max_channel(radiosity_w_m2.values[k]), floor);
    scale_[k] = against > 0 ? 1.0f / against : 0.0f;  // a scene without light has no error
  }
  std::iota(refused_first_.begin(), refused_first_.end(), 0u);
}

float InterpolationError::of_patch(PatchId patch, api::FrameIndex a, api::FrameIndex f, api::FrameIndex b,
                                   float weight) const {
  const Rgb* row = interpolated_.row(patch);
  const Rgb missed = row[a] * (1.0f - weight) + row[b] * weight - row[f];
  float largest = std::max({std::abs(missed.r), std::abs(missed.g), std::abs(missed.b)});
  if (!noise_.empty()) {
    const float spread = std::sqrt(1.0f + weight * weight + (1.0f - weight) * (1.0f - weight));
    largest = std::max(0.0f, largest - kSignificance * spread * noise_[patch]);
  }
  return largest * scale_[std::size_t{patch} * interpolated_.frame_count + f];
}

double InterpolationError::at(api::FrameIndex a, api::FrameIndex f, api::FrameIndex b) const {
  return left_out(a, f, b, weight_of(a, f, b));
}

double InterpolationError::left_out(api::FrameIndex a, api::FrameIndex f, api::FrameIndex b,
                                    float weight) const {
  float largest = 0;
  for (PatchId patch = 0; patch < interpolated_.patch_count; ++patch)
    largest = std::max(largest, of_patch(patch, a, f, b, weight));
  return largest;
}

bool InterpolationError::within(api::FrameIndex a, api::FrameIndex b, double tolerance) {
  for (std::size_t k = 0; k < refused_first_.size(); ++k)
    for (api::FrameIndex f = a + 1; f < b; ++f)
      if (of_patch(refused_first_[k], a, f, b, weight_of(a, f, b)) > tolerance) {
        std::swap(refused_first_[k], refused_first_[k / 2]);
        return false;
      }
  return true;
}

double InterpolationError::largest(api::FrameIndex a, api::FrameIndex b) const {
  double largest = 0;
  for (api::FrameIndex f = a + 1; f < b; ++f) largest = std::max(largest, at(a, f, b));
  return largest;
}

}  // namespace engine
