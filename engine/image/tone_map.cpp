#include "engine/image/tone_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "engine/base/widest.h"

namespace engine {
namespace {

// The table's points are equidistant within each octave: 2^7 of them, from 2^-16 to 2^16, so that the upper
// bits of a float are its index and the lower ones the fraction to the next point.
constexpr unsigned kMantissaBits = 23, kPointBits = 7, kFractionBits = kMantissaBits - kPointBits;
constexpr float kLowest = 0x1p-16f, kHighest = 0x1p16f;
constexpr std::uint32_t kFirstIndex = std::bit_cast<std::uint32_t>(kLowest) >> kFractionBits;
constexpr std::uint32_t kPoints = (32u << kPointBits) + 1;

std::int32_t bits_of(float x) {
  return std::bit_cast<std::int32_t>(x);
}

/// In vectors: floats that are not negative are limited as the integers of their bits, since compilers make
/// branches of a choice between floats. Below the first point values are proportional to its own.
/// `encoded`: kPoints + 1, the last one twice.
KEYLUME_WIDEST void show_by_table(const float* __restrict radiance, std::size_t count, float factor,
                                  const float* __restrict encoded, std::uint8_t* __restrict shown) {
  for (std::size_t k = 0; k < count; ++k) {
    const float exposed = radiance[k] * factor;
    const std::int32_t positive = bits_of(exposed) & -static_cast<std::int32_t>(exposed > 0.0f);  // nor NaN
    const std::int32_t bits = std::min(std::max(positive, bits_of(kLowest)), bits_of(kHighest));
    const std::int32_t i = (bits >> kFractionBits) - static_cast<std::int32_t>(kFirstIndex);
    const float fraction = static_cast<float>(bits & ((1 << kFractionBits) - 1)) * 0x1p-16f;
    const float of_first = std::bit_cast<float>(positive) * (1 / kLowest);
    const auto share = std::bit_cast<float>(std::min(bits_of(of_first), bits_of(1.0f)));
    const float value = share * (encoded[i] + fraction * (encoded[i + 1] - encoded[i]));
    shown[k] = static_cast<std::uint8_t>(static_cast<std::int32_t>(value + 0.5f));
  }
}

}  // namespace

double auto_exposure_factor(const Patches& patches, const Animation& animation,
                            const PatchSeries& radiosity_w_m2) {
  std::vector<bool> emits;  // [material]
  for (std::uint32_t m = 0; m < animation.emission.exitance_w_m2.size(); ++m)
    emits.push_back(animation.emission.ever_emits(m));
  double power = 0, area = 0;
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    if (emits[patches.facets[patches.facet_of[patch]].material] && !patches.is_back(patch)) continue;
    double sum = 0;
    for (std::uint32_t f = 0; f < radiosity_w_m2.frame_count; ++f) {
      const Rgb b = radiosity_w_m2.at(patch, f);
      sum += 0.2126 * b.r + 0.7152 * b.g + 0.0722 * b.b;
    }
    power += patches.area_m2[patch] * sum;
    area += static_cast<double>(patches.area_m2[patch]) * radiosity_w_m2.frame_count;
  }
  return power > 0 ? kMiddleGrey * std::numbers::pi * area / power : 1.0;
}

DisplayTable::DisplayTable(api::ToneMap tone_map, double exposure_factor)
    : factor_(static_cast<float>(exposure_factor)), encoded_(kPoints + 1) {
  const double white = tone_curve_white(tone_map);
  white_radiance_ = static_cast<float>(white / exposure_factor);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const auto exposed = std::bit_cast<float>((kFirstIndex + i) << kFractionBits);
    encoded_[i] = static_cast<float>(255 * srgb_encode(tone_curve(tone_map, exposed)));
  }
  encoded_[kPoints] = encoded_[kPoints - 1];
}

std::uint8_t DisplayTable::operator()(float radiance) const {
  std::uint8_t shown = 0;
  show({&radiance, 1}, &shown);
  return shown;
}

void DisplayTable::show(std::span<const float> radiance, std::uint8_t* shown) const {
  show_by_table(radiance.data(), radiance.size(), factor_, encoded_.data(), shown);
}

}  // namespace engine
