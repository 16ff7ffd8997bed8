#include "engine/patches/texture_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace engine {
namespace {

/// Colours are given as sRGB levels; what they stand for is read back with texel().
Texture noise(std::uint32_t width, std::uint32_t height) {
  Texture texture{width, height, {}};
  std::minstd_rand random(7);
  for (std::uint32_t i = 0; i < width * height; ++i)
    texture.srgb.push_back({static_cast<std::uint8_t>(random() % 256),
                            static_cast<std::uint8_t>(random() % 256),
                            static_cast<std::uint8_t>(i % 2 * 255)});
  return texture;
}

/// The texel under a point of the plane, repeated.
Rgb at(const Texture& texture, double u, double v) {
  const auto index = [](double turns, std::uint32_t count) {
    return std::min(static_cast<std::uint32_t>((turns - std::floor(turns)) * count), count - 1);
  };
  const Rgb rho = texel(texture, index(u, texture.width), index(-v, texture.height));
  return {std::min(rho.r, kTexelMax), std::min(rho.g, kTexelMax), std::min(rho.b, kTexelMax)};
}

/// By 4 million midpoints: texels that a midpoint grid of side n cuts wrongly make errors of some 1 / n of
/// their share, of both signs.
Rgb by_midpoints(const Texture& texture, const std::array<TexturePoint, 3>& t) {
  constexpr int kSide = 2000;
  double r = 0, g = 0, b = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      double x = (i + 0.5) / kSide, y = (j + 0.5) / kSide;
      if (x + y > 1) x = 1 - x, y = 1 - y;
      const Rgb rho = at(texture, t[0].u + x * (t[1].u - t[0].u) + y * (t[2].u - t[0].u),
                         t[0].v + x * (t[1].v - t[0].v) + y * (t[2].v - t[0].v));
      r += rho.r;
      g += rho.g;
      b += rho.b;
    }
  const double n = double{kSide} * kSide;
  return {static_cast<float>(r / n), static_cast<float>(g / n), static_cast<float>(b / n)};
}

void expect_near(Rgb a, Rgb b, float tolerance) {
  EXPECT_NEAR(a.r, b.r, tolerance);
  EXPECT_NEAR(a.g, b.g, tolerance);
  EXPECT_NEAR(a.b, b.b, tolerance);
}

TEST(TexturePyramid, EveryLevelHasTheMeanOfTheTextureWhateverItsSize) {
  const Texture textures[] = {noise(5, 3), noise(1, 7), noise(8, 8), noise(13, 1)};
  for (const Texture& texture : textures) {
    const TexturePyramid pyramid = build_pyramid(texture);
    EXPECT_EQ(pyramid.width(pyramid.level_count() - 1), 1u);
    EXPECT_EQ(pyramid.height(pyramid.level_count() - 1), 1u);
    Rgb first;
    for (std::uint32_t level = 0; level < pyramid.level_count(); ++level) {
      Rgb sum;
      for (std::uint32_t y = 0; y < pyramid.height(level); ++y)
        for (std::uint32_t x = 0; x < pyramid.width(level); ++x) sum += pyramid.at(level, x, y);
      const Rgb mean = sum * (1.0f / static_cast<float>(pyramid.width(level) * pyramid.height(level)));
      if (level == 0) first = mean;
      expect_near(mean, first, 1e-6f);
    }
  }
}

TEST(MeanOverTriangle, InsideOneTexelIsThatTexelAndRepeats) {
  const Texture texture = noise(4, 4);
  const TexturePyramid pyramid = build_pyramid(texture);
  // Column 1 and, counted from the top, row 2: u in 0.25 .. 0.5, v in 0.25 .. 0.5.
  const Rgb expected = pyramid.at(0, 1, 2);
  expect_near(mean_over_triangle(
                  pyramid, {TexturePoint{0.26, 0.26}, TexturePoint{0.49, 0.3}, TexturePoint{0.3, 0.49}}),
              expected, 1e-6f);
  expect_near(mean_over_triangle(
                  pyramid, {TexturePoint{-9.74, 7.26}, TexturePoint{-9.51, 7.3}, TexturePoint{-9.7, 7.49}}),
              expected, 1e-6f);
}

// The unit triangle below the diagonal of a 2 x 2 texture holds half of the two texels on the diagonal and
// the whole of the one between.
TEST(MeanOverTriangle, WeighsTexelsByTheAreaCovered) {
  const Texture texture = noise(2, 2);
  const TexturePyramid pyramid = build_pyramid(texture);
  const Rgb mean = mean_over_triangle(pyramid, {TexturePoint{0, 0}, TexturePoint{1, 0}, TexturePoint{1, 1}});
  const Rgb lower_left = pyramid.at(0, 0, 1), lower_right = pyramid.at(0, 1, 1),
            upper_right = pyramid.at(0, 1, 0);
  expect_near(mean, 0.25f * lower_left + 0.5f * lower_right + 0.25f * upper_right, 1e-6f);
}

TEST(MeanOverTriangle, AgreesWithPointsOnAnyTriangle) {
  const Texture texture = noise(23, 17);
  const TexturePyramid pyramid = build_pyramid(texture);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-1.2, 1.7);
  for (int k = 0; k < 8; ++k) {
    std::array<TexturePoint, 3> t;
    for (auto& p : t) p = {anywhere(random), anywhere(random)};
    expect_near(mean_over_triangle(pyramid, t), by_midpoints(texture, t), 5e-4f);
  }
}

// 300 x 300 texels of noise under a triangle of up to 45 000 of them: blocks of 4 x 4. A block has the
// contrast of noise, 0.3 / 4; were all of the rim (a tenth) wrong by that, the mean would err by 0.0075.
TEST(MeanOverTriangle, BlocksOfTexelsKeepTheStatedError) {
  const Texture texture = noise(300, 300);
  const TexturePyramid pyramid = build_pyramid(texture);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(0, 1);
  for (int k = 0; k < 8; ++k) {
    std::array<TexturePoint, 3> t;
    for (auto& p : t) p = {anywhere(random), anywhere(random)};
    expect_near(mean_over_triangle(pyramid, t), by_midpoints(texture, t), 0.0075f);
  }
}

TEST(MeanOverTriangle, OverManyRepetitionsIsTheMeanOfTheTexture) {
  const Texture texture = noise(6, 5);
  const TexturePyramid pyramid = build_pyramid(texture);
  const Rgb mean = pyramid.at(pyramid.level_count() - 1, 0, 0);
  for (const double size : {500.0, 1e5, 1e9})
    expect_near(
        mean_over_triangle(pyramid, {TexturePoint{0.3, 0.2}, TexturePoint{size, 0}, TexturePoint{0, size}}),
        mean, 1e-3f);
}

TEST(MeanOverTriangle, OfAPointIsItsTexelAndOfALineTheTexelsAlongIt) {
  const Texture texture = noise(4, 4);
  const TexturePyramid pyramid = build_pyramid(texture);
  const TexturePoint p{0.3, 0.3};
  expect_near(mean_over_triangle(pyramid, {p, p, p}), pyramid.at(0, 1, 2), 1e-6f);
  // Along the row at v = 0.3: a triangle folded to a line covers it 2 (1 - x) times as densely.
  const Rgb along =
      mean_over_triangle(pyramid, {TexturePoint{0, 0.3}, TexturePoint{1, 0.3}, TexturePoint{0, 0.3}});
  Rgb expected;
  for (std::uint32_t x = 0; x < 4; ++x)
    expected += (7 - 2 * static_cast<float>(x)) / 16 * pyramid.at(0, x, 2);
  expect_near(along, expected, 1e-6f);
}

}  // namespace
}  // namespace engine
