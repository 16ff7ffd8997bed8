#include "engine/image/shade.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include "engine/base/widest.h"

namespace engine {
namespace {

struct Blends {
  const NodeWeight* plain;
  const TintedWeight* tinted;
  const std::uint32_t *plain_end, *tinted_end;
  std::size_t pixels;
};

/// [channel][lane] of a pixel: sum of weight x node value, then / pi. Inlined where `lanes` is a constant, so
/// that the sums stay in registers.
[[gnu::always_inline]] inline void shade(const Blends& blends, const float* values, std::uint32_t lanes,
                                         float* out) {
  const std::size_t stride = std::size_t{3} * lanes;
  std::uint32_t plain = 0, tinted = 0;
  for (std::size_t x = 0; x < blends.pixels; ++x, out += stride) {
    float sum[3 * kFrameLanes] = {};
    for (; plain < blends.plain_end[x]; ++plain) {
      const NodeWeight part = blends.plain[plain];
      const float* const value = values + stride * part.node;
      for (std::size_t i = 0; i < stride; ++i) sum[i] += part.weight * value[i];
    }
    for (; tinted < blends.tinted_end[x]; ++tinted) {
      const TintedWeight part = blends.tinted[tinted];
      const float* const value = values + stride * part.node;
      for (std::uint32_t l = 0; l < lanes; ++l) {
        sum[l] += part.weight.r * value[l];
        sum[lanes + l] += part.weight.g * value[lanes + l];
        sum[2 * lanes + l] += part.weight.b * value[2 * lanes + l];
      }
    }
    for (std::size_t i = 0; i < stride; ++i) out[i] = sum[i] * std::numbers::inv_pi_v<float>;
  }
}

KEYLUME_WIDEST void shade_lanes(const Blends& blends, const float* values, std::uint32_t lanes, float* out) {
  if (lanes == kFrameLanes)
    shade(blends, values, kFrameLanes, out);
  else
    shade(blends, values, lanes, out);
}

}  // namespace

LaneValues gather_lanes(std::span<const NodeValues> frames,
                        const std::function<float(std::size_t)>& largest_of) {
  LaneValues gathered;
  gathered.frame_count = static_cast<std::uint32_t>(frames.size());
  gathered.lanes = std::bit_ceil(gathered.frame_count);
  const std::size_t lanes = gathered.lanes;
  gathered.values.resize(3 * lanes * frames[0].size());
  for (std::size_t node = 0; node < frames[0].size(); ++node) {
    float* const out = gathered.values.data() + 3 * lanes * node;
    const float largest = largest_of(node);
    for (std::size_t lane = 0; lane < frames.size(); ++lane) {
      const Rgb value = frames[lane][node];
      out[lane] = std::min(value.r, largest);
      out[lanes + lane] = std::min(value.g, largest);
      out[2 * lanes + lane] = std::min(value.b, largest);
    }
  }
  return gathered;
}

void shade_row(const PixelRow& row, const LaneValues& values, std::span<float> radiance) {
  shade_lanes({row.plain.data(), row.tinted.data(), row.plain_end.data(), row.tinted_end.data(),
               row.plain_end.size()},
              values.values.data(), values.lanes, radiance.data());
}

void shade_pixel(const PixelRow& pixel, const LaneValues& values, std::uint32_t lane, float* radiance) {
  const std::size_t lanes = values.lanes;
  const auto value_of = [&](std::uint32_t node) {
    const float* const value = values.values.data() + 3 * lanes * node + lane;
    return Rgb{value[0], value[lanes], value[2 * lanes]};
  };
  Rgb radiosity;
  for (const NodeWeight& part : pixel.plain) radiosity += part.weight * value_of(part.node);
  for (const TintedWeight& part : pixel.tinted) radiosity += part.weight * value_of(part.node);
  const Rgb shown = radiosity * std::numbers::inv_pi_v<float>;
  radiance[lane] = shown.r;
  radiance[lanes + lane] = shown.g;
  radiance[2 * lanes + lane] = shown.b;
}

}  // namespace engine
