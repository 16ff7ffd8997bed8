#include "engine/interpolate/interpolate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace engine {
namespace {

using api::FrameIndex;
using api::Interpolation;

constexpr Interpolation kBoth[] = {Interpolation::linear, Interpolation::monotone_cubic};

std::vector<FrameIndex> frames_up_to(FrameIndex last) {
  std::vector<FrameIndex> frames(last + 1);
  std::iota(frames.begin(), frames.end(), 0u);
  return frames;
}

/// Red of what `kind` makes of red at the knots, at frames 0 .. last.
std::vector<float> curve(const std::vector<FrameIndex>& knots, const std::vector<float>& at_knots,
                         FrameIndex last, Interpolation kind) {
  const Interpolator interpolator(knots, frames_up_to(last), kind);
  std::vector<Rgb> known, found(last + 1);
  for (const float value : at_knots) known.push_back({value, 0, 0});
  interpolator.apply(known.data(), found.data());
  std::vector<float> red;
  for (const Rgb value : found) red.push_back(value.r);
  return red;
}

TEST(Interpolator, LinearLiesOnTheLineBetweenNeighbours) {
  const auto found = curve({2, 5, 9}, {1, 4, 0}, 9, Interpolation::linear);
  const std::vector<float> expected{1, 1, 1, 2, 3, 4, 3, 2, 1, 0};
  for (std::size_t f = 0; f < expected.size(); ++f) EXPECT_FLOAT_EQ(found[f], expected[f]) << f;
}

TEST(Interpolator, BeforeTheFirstAndAfterTheLastKnotTheValueIsHeld) {
  for (const Interpolation kind : kBoth) {
    const auto found = curve({2, 5, 9}, {1, 4, 0.3f}, 12, kind);
    EXPECT_EQ(found[0], 1);
    EXPECT_EQ(found[1], 1);
    EXPECT_EQ(found[10], 0.3f);
    EXPECT_EQ(found[12], 0.3f);
    EXPECT_EQ(curve({3}, {7}, 6, kind), std::vector<float>(7, 7.0f));
  }
}

TEST(Interpolator, AtKnotsExactlyTheirBytesAreGiven) {
  const std::vector<FrameIndex> knots{0, 3, 4, 9};
  const std::vector<Rgb> known{{0.1f, 1e-30f, 3e20f}, {0.7f, 0, 0.3f}, {0.3f, 1e-38f, 5}, {0.1f, 7, 1e9f}};
  for (const Interpolation kind : kBoth) {
    const Interpolator interpolator(knots, knots, kind);
    std::vector<Rgb> found(4);
    interpolator.apply(known.data(), found.data());
    EXPECT_EQ(found, known);
  }
}

// By hand. h = 2, 4, 2 and d = 1/2, 1/4, 2, so the slopes are 7/12, 9/26, 18/37 and 31/12. In the middle of
// an interval the curve is the mean of its ends and h / 8 of the difference of their slopes.
TEST(Interpolator, CubicHasTheSlopesOfFritschAndButland) {
  const auto found = curve({0, 2, 6, 8}, {0, 1, 2, 6}, 8, Interpolation::monotone_cubic);
  EXPECT_NEAR(found[1], 0.5 + (7.0 / 12 - 9.0 / 26) / 4, 1e-6);
  EXPECT_NEAR(found[4], 1.5 + (9.0 / 26 - 18.0 / 37) / 2, 1e-6);
  EXPECT_NEAR(found[7], 4.0 + (18.0 / 37 - 31.0 / 12) / 4, 2e-6);
  // A quarter of the way t = 1/4: h00 = 27/32, h01 = 5/32, h t (1-t)^2 = 9/16, h t^2 (t-1) = -3/16.
  EXPECT_NEAR(found[3], 27.0 / 32 + 2 * 5.0 / 32 + 9.0 / 26 * 9 / 16 - 18.0 / 37 * 3 / 16, 1e-6);
}

// The data of Akima (J. ACM 17, 1970) that Fritsch & Carlson test with. Slopes by hand: 81/106 at 9,
// 945/1936 * 9.6 = 4.68595 at 11, 105/11 at 12, 9 at 14.
TEST(Interpolator, CubicFollowsTheDataOfAkimaWithoutAWiggle) {
  const std::vector<FrameIndex> knots{0, 2, 3, 5, 6, 8, 9, 11, 12, 14, 15};
  const std::vector<float> values{10, 10, 10, 10, 10, 10, 10.5f, 15, 50, 60, 85};
  const auto found = curve(knots, values, 15, Interpolation::monotone_cubic);
  for (FrameIndex f = 0; f <= 8; ++f) EXPECT_FLOAT_EQ(found[f], 10) << f;
  EXPECT_NEAR(found[10], 12.75 + (9 / (5 / 0.5 + 4 / 2.25) - 9 / (4 / 2.25 + 5 / 35.0)) / 4, 2e-5);
  EXPECT_NEAR(found[13], 55 + (105.0 / 11 - 9) / 4, 2e-5);
}

TEST(Interpolator, StraightLinesStayStraight) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-2, 2);
  for (int k = 0; k < 100; ++k) {
    const float a = uniform(random), b = uniform(random);
    std::vector<FrameIndex> knots{0};
    while (knots.back() < 30) knots.push_back(knots.back() + 1 + static_cast<FrameIndex>(random() % 7));
    std::vector<float> values;
    for (const FrameIndex knot : knots) values.push_back(a + b * static_cast<float>(knot));
    for (const Interpolation kind : kBoth) {
      const auto found = curve(knots, values, knots.back(), kind);
      for (FrameIndex f = 0; f < found.size(); ++f)
        ASSERT_NEAR(found[f], a + b * static_cast<float>(f), 80 * 1e-6);  // of values up to 80
    }
  }
}

/// Knots from 0 in random steps, one value each.
struct RandomCurve {
  std::vector<FrameIndex> knots{0};
  std::vector<float> values;
  explicit RandomCurve(std::mt19937& random) {
    const std::size_t count = 3 + random() % 8;
    while (knots.size() < count) knots.push_back(knots.back() + 1 + static_cast<FrameIndex>(random() % 12));
    std::uniform_real_distribution<float> uniform(0, 1);
    for (std::size_t k = 0; k < count; ++k)
      values.push_back(random() % 4 == 0 && k > 0 ? values.back() : uniform(random));
  }
};

// Values are up to 1, so sums are rounded by less than 1e-6.
TEST(Interpolator, CubicNeverLeavesTheRangeOfItsTwoKnots) {
  std::mt19937 random(2);
  int bent = 0;
  for (int k = 0; k < 500; ++k) {
    const RandomCurve given(random);
    const auto cubic = curve(given.knots, given.values, given.knots.back(), Interpolation::monotone_cubic);
    const auto linear = curve(given.knots, given.values, given.knots.back(), Interpolation::linear);
    for (std::size_t i = 0; i + 1 < given.knots.size(); ++i)
      for (FrameIndex f = given.knots[i]; f < given.knots[i + 1]; ++f) {
        const auto [low, high] = std::minmax(given.values[i], given.values[i + 1]);
        ASSERT_GE(cubic[f], low - 1e-6f) << "case " << k << " frame " << f;
        ASSERT_LE(cubic[f], high + 1e-6f) << "case " << k << " frame " << f;
        bent += std::abs(cubic[f] - linear[f]) > 0.01f ? 1 : 0;
      }
  }
  EXPECT_GT(bent, 1000) << "the cubic is hardly more than the line";
}

TEST(Interpolator, MonotoneDataGiveAMonotoneCubic) {
  std::mt19937 random(3);
  for (int k = 0; k < 500; ++k) {
    RandomCurve given(random);
    std::sort(given.values.begin(), given.values.end());
    const auto found = curve(given.knots, given.values, given.knots.back(), Interpolation::monotone_cubic);
    for (FrameIndex f = 1; f < found.size(); ++f) ASSERT_GE(found[f], found[f - 1] - 1e-6f) << "case " << k;
  }
}

// What is smooth between the knots has no corner at them: one-sided differences over a tenth of an interval
// of 100 frames are nearer to each other than those of the line.
TEST(Interpolator, CubicHasNoCornerAtAKnot) {
  const std::vector<FrameIndex> knots{0, 100, 200, 300};
  const std::vector<float> values{0, 1, 4, 5};
  const auto corner = [&](Interpolation kind) {
    const auto found = curve(knots, values, 300, kind);
    return std::abs(found[105] - 2 * found[100] + found[95]);
  };
  EXPECT_NEAR(corner(Interpolation::linear), 0.1, 1e-5);
  EXPECT_LT(corner(Interpolation::monotone_cubic), 0.02);
}

TEST(Interpolator, WithTwoKnotsCubicIsLinear) {
  EXPECT_EQ(curve({1, 8}, {0.3f, 2}, 9, Interpolation::monotone_cubic),
            curve({1, 8}, {0.3f, 2}, 9, Interpolation::linear));
}

// 3,000 patches, more than one task of patches; every channel by itself.
TEST(Interpolate, EveryPatchFrameAndChannelByItself) {
  constexpr std::uint32_t kPatches = 3'000;
  const std::vector<FrameIndex> knots{0, 4, 6};
  PatchSeries known(kPatches, 3);
  for (PatchId p = 0; p < kPatches; ++p)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto frame = static_cast<float>(knots[k]);
      known.at(p, k) = {frame * static_cast<float>(p), 1 - frame, k == 1 ? 8.0f : 0.0f};
    }
  const PatchSeries all = interpolate(known, Interpolator(knots, frames_up_to(7), Interpolation::linear));
  ASSERT_EQ(all.patch_count, kPatches);
  ASSERT_EQ(all.frame_count, 8u);
  constexpr float kBlue[8] = {0, 2, 4, 6, 8, 4, 0, 0};
  for (PatchId p = 0; p < kPatches; ++p)
    for (FrameIndex f = 0; f < 8; ++f) {
      const auto frame = static_cast<float>(std::min(f, 6u));
      ASSERT_FLOAT_EQ(all.at(p, f).r, frame * static_cast<float>(p));
      ASSERT_FLOAT_EQ(all.at(p, f).g, 1 - frame);
      ASSERT_FLOAT_EQ(all.at(p, f).b, kBlue[f]);
    }
}

// Green is monotone and blue is not: had they a slope in common, blue would overshoot at its peak.
TEST(Interpolate, CubicTakesEveryChannelByItself) {
  const std::vector<FrameIndex> knots{0, 4, 8};
  PatchSeries known(1, 3);
  for (std::uint32_t k = 0; k < 3; ++k) known.at(0, k) = {2, static_cast<float>(k * k), k == 1 ? 1.0f : 0.0f};
  const PatchSeries all =
      interpolate(known, Interpolator(knots, frames_up_to(8), Interpolation::monotone_cubic));
  const auto green = curve(knots, {0, 1, 4}, 8, Interpolation::monotone_cubic);
  const auto blue = curve(knots, {0, 1, 0}, 8, Interpolation::monotone_cubic);
  for (FrameIndex f = 0; f <= 8; ++f) {
    EXPECT_FLOAT_EQ(all.at(0, f).r, 2);
    EXPECT_EQ(all.at(0, f).g, green[f]);
    EXPECT_EQ(all.at(0, f).b, blue[f]);
    EXPECT_LE(all.at(0, f).b, 1.0f);
  }
}

}  // namespace
}  // namespace engine
