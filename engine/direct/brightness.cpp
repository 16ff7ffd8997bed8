#include "engine/direct/brightness.h"

#include <algorithm>
#include <numbers>

namespace engine {
namespace {

Rgb mean_of(const std::vector<Rgb>& series) {
  double r = 0, g = 0, b = 0;
  for (const Rgb& value : series) {
    r += value.r;
    g += value.g;
    b += value.b;
  }
  const double n = std::max<double>(1, static_cast<double>(series.size()));
  return {static_cast<float>(r / n), static_cast<float>(g / n), static_cast<float>(b / n)};
}

/// `series`: [frame], or one.
Brightness brightness_of(const std::vector<Rgb>& series, std::span<const FrameIndex> frames) {
  Brightness brightness;
  for (const Rgb& value : series) brightness.peak = std::max(brightness.peak, max_channel(value));
  brightness.importance = brightness.peak;
  brightness.mean = mean_of(series);
  for (std::uint32_t slot = 0; slot < frames.size(); ++slot) {
    brightness.of_slot.push_back(in_frame(series, frames[slot]));
    if (max_channel(brightness.of_slot[slot]) > 0) brightness.lit.set(slot, slot);
  }
  return brightness;
}

/// All curves of brightness, and how much light there is of each at brightness 1: intensity of all its facets
/// along their normals [m^2], 1 for a source. Units differ, which only makes the choice of lights less good.
struct Curves {
  std::vector<const std::vector<Rgb>*> series;
  std::vector<double> amount;
};

Curves curves_of(const Patches& patches, const Emission& emission) {
  Curves curves;
  for (const auto& series : emission.exitance_w_m2) curves.series.push_back(&series);
  for (const SourceMotion& source : emission.sources) curves.series.push_back(&source.intensity);
  curves.amount.resize(emission.exitance_w_m2.size());
  for (const Facet& facet : patches.facets)
    curves.amount[facet.material] += facet.area_m2 * std::numbers::inv_pi;
  curves.amount.resize(curves.series.size(), 1.0);
  return curves;
}

/// Largest share of all light that each curve has in any frame, s_m = max_f a_m e_m(f) / sum_k a_k e_k(f).
std::vector<double> largest_shares(const Curves& curves) {
  std::size_t frames = 1;
  for (const auto* series : curves.series) frames = std::max(frames, series->size());
  std::vector<double> shares(curves.series.size(), 0.0), now(curves.series.size());
  for (std::size_t f = 0; f < frames; ++f) {
    double all = 0;
    for (std::size_t m = 0; m < now.size(); ++m) {
      now[m] = curves.amount[m] * max_channel(in_frame(*curves.series[m], static_cast<FrameIndex>(f)));
      all += now[m];
    }
    for (std::size_t m = 0; all > 0 && m < now.size(); ++m) shares[m] = std::max(shares[m], now[m] / all);
  }
  return shares;
}

}  // namespace

BrightnessTable brightness_table(const Patches& patches, const Emission& emission,
                                 std::span<const FrameIndex> frames) {
  const Curves curves = curves_of(patches, emission);
  BrightnessTable table;
  for (const auto* series : curves.series) table.of.push_back(brightness_of(*series, frames));
  const std::vector<double> shares = largest_shares(curves);
  double sum = 0;
  for (std::size_t m = 0; m < shares.size(); ++m) {
    if (curves.amount[m] > 0) table.of[m].importance = static_cast<float>(shares[m] / curves.amount[m]);
    sum += shares[m];
  }
  table.variety = std::max(1.0f, static_cast<float>(sum));
  return table;
}

}  // namespace engine
