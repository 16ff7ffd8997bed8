#include "engine/interpolate/interpolate.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"

namespace engine {
namespace {

constexpr std::uint32_t kPatchesPerTask = 256;

/// Slope of a parabola through three knots at the first of them, limited to keep the curve monotone. h, d:
/// the lengths and secants of the first and the second interval.
float end_slope(float h0, float h1, float d0, float d1) {
  const float slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  if (d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
  return slope;
}

float inner_slope(float h0, float h1, float d0, float d1) {
  if (d0 * d1 <= 0) return 0;
  const float w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

template <class Slope>
Rgb per_channel(Rgb d0, Rgb d1, Slope&& slope) {
  return {slope(d0.r, d1.r), slope(d0.g, d1.g), slope(d0.b, d1.b)};
}

}  // namespace

Interpolator::Interpolator(std::span<const api::FrameIndex> knots, std::span<const api::FrameIndex> frames,
                           api::Interpolation kind)
    : knots_(knots.begin(), knots.end()), kind_(kind) {
  for (const api::FrameIndex frame : frames) {
    const auto after = std::lower_bound(knots_.begin(), knots_.end(), frame);
    const auto position = static_cast<std::uint32_t>(after - knots_.begin());
    if (after == knots_.end())
      places_.push_back({position - 1, position - 1, 0});
    else if (*after == frame || position == 0)
      places_.push_back({position, position, 0});
    else
      places_.push_back({position - 1, position,
                         static_cast<float>(frame - knots_[position - 1]) /
                             static_cast<float>(knots_[position] - knots_[position - 1])});
  }
}

void Interpolator::apply(const Rgb* at_knots, Rgb* to) const {
  if (kind_ == api::Interpolation::monotone_cubic && knots_.size() > 2) return apply_cubic(at_knots, to);
  for (std::size_t f = 0; f < places_.size(); ++f) {
    const Place& at = places_[f];
    to[f] = at.before == at.after ? at_knots[at.before]
                                  : at_knots[at.before] * (1.0f - at.weight) + at_knots[at.after] * at.weight;
  }
}

void Interpolator::apply_cubic(const Rgb* at_knots, Rgb* to) const {
  const std::size_t last = knots_.size() - 1;
  thread_local std::vector<float> h;
  thread_local std::vector<Rgb> d, slope;
  h.resize(last);
  d.resize(last);
  slope.resize(last + 1);
  for (std::size_t k = 0; k < last; ++k) {
    h[k] = static_cast<float>(knots_[k + 1] - knots_[k]);
    d[k] = (at_knots[k + 1] - at_knots[k]) * (1.0f / h[k]);
  }
  slope[0] = per_channel(d[0], d[1], [&](float a, float b) { return end_slope(h[0], h[1], a, b); });
  slope[last] = per_channel(d[last - 1], d[last - 2],
                            [&](float a, float b) { return end_slope(h[last - 1], h[last - 2], a, b); });
  for (std::size_t k = 1; k < last; ++k)
    slope[k] =
        per_channel(d[k - 1], d[k], [&](float a, float b) { return inner_slope(h[k - 1], h[k], a, b); });
  for (std::size_t f = 0; f < places_.size(); ++f) {
    const Place& at = places_[f];
    to[f] = at_knots[at.before];
    if (at.before == at.after) continue;
    const float t = at.weight, length = h[at.before];
    // Hermite's basis, written as the linear part and what the slopes add to it.
    to[f] = at_knots[at.before] * (1 + t * t * (2 * t - 3)) + at_knots[at.after] * (t * t * (3 - 2 * t)) +
            slope[at.before] * (length * t * (1 - t) * (1 - t)) +
            slope[at.after] * (length * t * t * (t - 1));
  }
}

PatchSeries interpolate(const PatchSeries& at_knots, const Interpolator& interpolator) {
  PatchSeries all(at_knots.patch_count, interpolator.frame_count());
  parallel_for((all.patch_count + kPatchesPerTask - 1) / kPatchesPerTask, [&](std::size_t task) {
    const PatchId first = static_cast<PatchId>(task) * kPatchesPerTask;
    for (PatchId patch = first; patch < std::min(first + kPatchesPerTask, all.patch_count); ++patch)
      interpolator.apply(at_knots.row(patch), all.row(patch));
  });
  return all;
}

}  // namespace engine
