#include "engine/keyframes/interpolation_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/interpolate/interpolate.h"
#include "engine/keyframes/fewest_key_frames.h"

namespace engine {
namespace {

constexpr std::size_t kOfGroup = ReplicateSeries::kOfGroup;  ///< mean, then replicates

float largest_channel(Rgb value) {
  return std::max({std::abs(value.r), std::abs(value.g), std::abs(value.b)});
}

/// Standard error of the mean of `all`, per channel.
Rgb standard_error(const std::array<Rgb, kOfGroup>& all) {
  Rgb squares;
  for (std::size_t r = 1; r < kOfGroup; ++r) {
    const Rgb off = all[r] - all[0];
    squares += off * off;
  }
  constexpr float kShare = 1.0f / (kEstimateReplicates * (kEstimateReplicates - 1));
  return {std::sqrt(squares.r * kShare), std::sqrt(squares.g * kShare), std::sqrt(squares.b * kShare)};
}

/// Interpolates to every frame from knots that include `ends`, each stretch between two of these by itself.
class StretchInterpolator {
 public:
  StretchInterpolator(std::span<const FrameIndex> knots, std::span<const FrameIndex> ends,
                      api::Interpolation kind) {
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      std::vector<FrameIndex> frames(ends[k + 1] - ends[k] + 1);
      std::iota(frames.begin(), frames.end(), ends[k]);
      const auto begin = std::lower_bound(knots.begin(), knots.end(), ends[k]);
      const auto end = std::upper_bound(begin, knots.end(), ends[k + 1]);
      stretches_.push_back(
          {static_cast<std::size_t>(begin - knots.begin()), ends[k], {{begin, end}, frames, kind}});
    }
  }

  void apply(const Rgb* at_knots, Rgb* to) const {
    for (const Stretch& stretch : stretches_)
      stretch.interpolator.apply(at_knots + stretch.first_knot, to + stretch.first_frame);
  }

 private:
  struct Stretch {
    std::size_t first_knot;
    FrameIndex first_frame;
    Interpolator interpolator;
  };
  std::vector<Stretch> stretches_;
};

}  // namespace

InterpolationError::InterpolationError(const LitScene& lit, const Estimate& estimate, api::Interpolated what)
    : values_(estimate.interpolated),
      frame_count_(values_.frame_count),
      group_count_(values_.group_count),
      ends_{0},
      weights_(estimate.radiosity_w_m2.values.size() * group_count_),
      relative_(estimate.radiosity_w_m2.values.size()),
      refused_first_(lit.patches.count()) {
  if (what == api::Interpolated::indirect)
    for (const FrameIndex frame : shared_frames(frame_count_)) ends_.push_back(frame);
  ends_.push_back(frame_count_ - 1);
  const auto floor = static_cast<float>(0.5 * mean_radiosity(lit, estimate.radiosity_w_m2));
  std::size_t at = 0;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch)
    for (FrameIndex f = 0; f < frame_count_; ++f, ++at) {
      const float against = std::max(max_channel(estimate.radiosity_w_m2.values[at]), floor);
      relative_[at] = against > 0 ? 1.0f / against : 0.0f;  // a scene without light has no error
      for (std::uint32_t g = 0; g < group_count_; ++g)
        weights_[at * group_count_ + g] =
            what == api::Interpolated::total
                ? Rgb{1, 1, 1}
                : lit.reflectance(patch, f) * in_frame(estimate.groups[g].group.scale, f);
    }
  std::iota(refused_first_.begin(), refused_first_.end(), 0u);
}

float InterpolationError::of_patch(PatchId patch, api::FrameIndex a, api::FrameIndex f, api::FrameIndex b,
                                   Evidence evidence) const {
  const float w = static_cast<float>(f - a) / static_cast<float>(b - a);
  const Rgb *at_a = values_.at(patch, a), *at_b = values_.at(patch, b), *at_f = values_.at(patch, f);
  const std::size_t row = std::size_t{patch} * frame_count_ + f;
  const std::size_t used = evidence == Evidence::likely ? 1 : kOfGroup;
  std::array<Rgb, kOfGroup> missed{};
  for (std::uint32_t g = 0; g < group_count_; ++g) {
    const Rgb weight = weights_[row * group_count_ + g];
    const std::size_t k = g * kOfGroup;
    for (std::size_t r = 0; r < used; ++r)
      missed[r] += weight * (at_a[k + r] * (1.0f - w) + at_b[k + r] * w - at_f[k + r]);
  }
  float error = largest_channel(missed[0]);
  if (evidence != Evidence::likely) {
    const float noise = kSignificance * max_channel(standard_error(missed));
    error = evidence == Evidence::surely ? error + noise : std::max(0.0f, error - noise);
  }
  return error * relative_[row];
}

bool InterpolationError::refuses(std::size_t first, std::size_t end, api::FrameIndex a, api::FrameIndex b,
                                 double tolerance, Evidence evidence) {
  for (std::size_t k = first; k < end; ++k)
    for (api::FrameIndex f = a + 1; f < b; ++f)
      if (of_patch(refused_first_[k], a, f, b, evidence) > tolerance) {
        const std::size_t to = k < refusing_ ? k / 2 : refusing_++;
        std::swap(refused_first_[k], refused_first_[to]);
        return true;
      }
  return false;
}

bool InterpolationError::seems_within(api::FrameIndex a, api::FrameIndex b, double tolerance,
                                      Evidence evidence) {
  return !refuses(0, refusing_, a, b, tolerance, evidence);
}

bool InterpolationError::within(api::FrameIndex a, api::FrameIndex b, double tolerance, Evidence evidence) {
  return !refuses(0, refused_first_.size(), a, b, tolerance, evidence);
}

std::vector<double> InterpolationError::largest(std::span<const api::FrameIndex> knots,
                                                api::Interpolation interpolation) const {
  const StretchInterpolator interpolator(knots, ends_, interpolation);
  std::vector<double> largest(frame_count_, 0.0);
  std::vector<Rgb> at_knots(knots.size()), found(frame_count_), missed(frame_count_);
  for (PatchId patch = 0; patch < refused_first_.size(); ++patch) {
    std::fill(missed.begin(), missed.end(), Rgb{});
    for (std::uint32_t g = 0; g < group_count_; ++g) {
      for (std::size_t k = 0; k < knots.size(); ++k) at_knots[k] = values_.at(patch, knots[k])[g * kOfGroup];
      interpolator.apply(at_knots.data(), found.data());
      for (FrameIndex f = 0; f < frame_count_; ++f)
        missed[f] += weights_[(std::size_t{patch} * frame_count_ + f) * group_count_ + g] *
                     (found[f] - values_.at(patch, f)[g * kOfGroup]);
    }
    for (FrameIndex f = 0; f < frame_count_; ++f)
      largest[f] = std::max(
          largest[f], double{largest_channel(missed[f])} * relative_[std::size_t{patch} * frame_count_ + f]);
  }
  return largest;
}

}  // namespace engine
