#include "engine/image/texture_filter.h"

#include <gtest/gtest.h>

namespace engine {
namespace {

constexpr std::array<std::uint8_t, 3> kBlack{0, 0, 0}, kWhite{255, 255, 255};

/// Columns of black and white in turn.
Texture stripes(std::uint32_t width, std::uint32_t height) {
  Texture texture{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i)
    texture.srgb.push_back(i % width % 2 == 0 ? kBlack : kWhite);
  return texture;
}

float grey(const TexturePyramid& pyramid, double u, double v, TextureFootprint footprint = {}) {
  return filtered_reflectance(pyramid, {u, v}, footprint).g;
}

TEST(TextureFilter, AMagnifiedTexelIsItselfAtItsCentreAndMixesLinearlyWithTheNext) {
  const Texture texture = stripes(4, 4);
  const TexturePyramid pyramid = build_pyramid(texture);
  EXPECT_NEAR(grey(pyramid, 0.125, 0.3), 0, 1e-6f);
  EXPECT_NEAR(grey(pyramid, 0.375, 0.3), kTexelMax, 1e-6f);
  EXPECT_NEAR(grey(pyramid, 0.125 + 0.25 * 0.3, 0.3), 0.3f * kTexelMax, 1e-6f);
}

TEST(TextureFilter, RepeatsInBothDirectionsWithoutASeam) {
  const Texture texture = stripes(4, 4);
  const TexturePyramid pyramid = build_pyramid(texture);
  for (double u = 0; u < 1; u += 0.037)
    for (const double turns : {-3.0, 1.0, 1000.0})
      EXPECT_NEAR(grey(pyramid, u + turns, -turns), grey(pyramid, u, 0), 1e-6f);
  EXPECT_NEAR(grey(pyramid, 0, 0.5), kTexelMax / 2, 1e-6f) << "between the last column and the first";
}

TEST(TextureFilter, AFootprintOfManyTexelsShowsTheirMeanWhateverItsPlace) {
  const Texture texture = stripes(64, 64);
  const TexturePyramid pyramid = build_pyramid(texture);
  for (double u = 0; u < 1; u += 0.0137)
    for (const double size : {2.0 / 64, 9.0 / 64, 0.5, 77.0})
      EXPECT_NEAR(grey(pyramid, u, u, {{size, 0}, {0, size}}), kTexelMax / 2, 1e-5f) << u << ' ' << size;
}

// Seen from its edge, along the stripes: 8 texels long and half a texel wide. A filter as wide as it is long
// would show grey.
TEST(TextureFilter, ALongFootprintAlongStripesKeepsThem) {
  const Texture texture = stripes(64, 64);
  const TexturePyramid pyramid = build_pyramid(texture);
  EXPECT_NEAR(grey(pyramid, 0.5 / 64, 0.3, {{0.5 / 64, 0}, {0, 8.0 / 64}}), 0, 1e-6f);
  EXPECT_NEAR(grey(pyramid, 1.5 / 64, 0.3, {{0, 8.0 / 64}, {0.5 / 64, 0}}), kTexelMax, 1e-6f);
}

TEST(TextureFilter, AnEndlessFootprintHasAnAnswer) {
  const Texture texture = stripes(8, 2);
  const TexturePyramid pyramid = build_pyramid(texture);
  EXPECT_NEAR(grey(pyramid, 0.3, 0.3, {{1e30, 1e30}, {0, 1e30}}), kTexelMax / 2, 1e-5f);
}

}  // namespace
}  // namespace engine
