#include "engine/image/shade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace engine {
namespace {

/// A row of pixels with up to 6 plain and 3 tinted weights each, some with none.
PixelRow random_row(std::uint32_t pixels, std::uint32_t nodes, bool tinted, std::mt19937& random) {
  std::uniform_real_distribution<float> number(0, 1);
  PixelRow row;
  for (std::uint32_t x = 0; x < pixels; ++x) {
    for (auto k = random() % 7; k > 0; --k)
      row.plain.push_back({static_cast<std::uint32_t>(random() % nodes), number(random)});
    for (auto k = tinted ? random() % 4 : 0; k > 0; --k)
      row.tinted.push_back(
          {static_cast<std::uint32_t>(random() % nodes), {number(random), number(random), number(random)}});
    row.plain_end.push_back(static_cast<std::uint32_t>(row.plain.size()));
    row.tinted_end.push_back(static_cast<std::uint32_t>(row.tinted.size()));
  }
  return row;
}

/// Pixel x of a row alone.
PixelRow pixel_of(const PixelRow& row, std::uint32_t x) {
  const auto part = [x](const auto& parts, const std::vector<std::uint32_t>& end) {
    const auto at = [&](std::uint32_t k) { return parts.begin() + static_cast<std::ptrdiff_t>(k); };
    return std::vector(at(x == 0 ? 0 : end[x - 1]), at(end[x]));
  };
  PixelRow pixel{part(row.plain, row.plain_end), part(row.tinted, row.tinted_end), {}, {}};
  pixel.plain_end.push_back(static_cast<std::uint32_t>(pixel.plain.size()));
  pixel.tinted_end.push_back(static_cast<std::uint32_t>(pixel.tinted.size()));
  return pixel;
}

class ShadedTogether : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Frames, ShadedTogether, testing::Range<std::size_t>(1, kFrameLanes + 1));

// To the last bit: a frame looks the same whatever frames it is rendered with.
TEST_P(ShadedTogether, FramesAreWhatEachIsAlone) {
  constexpr std::uint32_t kPixels = 53, kNodes = 40;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(0, 30);
  std::vector<std::vector<Rgb>> frames(GetParam(), std::vector<Rgb>(kNodes));
  for (auto& frame : frames)
    for (Rgb& value : frame) value = {number(random), number(random), number(random)};
  const auto limit = [](std::size_t node) { return node % 2 == 0 ? 20.0f : 1e30f; };
  const std::vector<NodeValues> values(frames.begin(), frames.end());
  const LaneValues together = gather_lanes(values, limit);
  for (const bool tinted : {false, true}) {
    const PixelRow row = random_row(kPixels, kNodes, tinted, random);
    std::vector<float> radiance(std::size_t{3} * together.lanes * kPixels);
    shade_row(row, together, radiance);
    for (std::size_t f = 0; f < frames.size(); ++f)
      for (std::uint32_t x = 0; x < kPixels; ++x) {
        Rgb sum;
        const PixelRow pixel = pixel_of(row, x);
        const auto value = [&](std::uint32_t node) {
          const Rgb v = frames[f][node];
          return Rgb{std::min(v.r, limit(node)), std::min(v.g, limit(node)), std::min(v.b, limit(node))};
        };
        for (const NodeWeight& part : pixel.plain) sum += part.weight * value(part.node);
        for (const TintedWeight& part : pixel.tinted) sum += part.weight * value(part.node);
        const Rgb expected = sum * std::numbers::inv_pi_v<float>;
        float* const shown = radiance.data() + std::size_t{3} * together.lanes * x;
        const auto shown_in_lane = [&] {
          return Rgb{shown[f], shown[together.lanes + f], shown[2 * together.lanes + f]};
        };
        ASSERT_EQ(shown_in_lane(), expected) << "frame " << f << " pixel " << x;
        shown[f] = -1;
        shade_pixel(pixel, together, static_cast<std::uint32_t>(f), shown);
        ASSERT_EQ(shown_in_lane(), expected) << "frame " << f << " pixel " << x << " alone";
      }
  }
}

}  // namespace
}  // namespace engine
