#include "engine/estimate/replicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace engine {
namespace {

constexpr std::uint32_t kPatches = 200, kFrames = 40, kReplicates = 4;

/// value(replicate, patch, frame), the same in every channel.
template <class Value>
Replicates replicates_of(Value&& value) {
  Replicates all;
  for (std::uint32_t r = 0; r < kReplicates; ++r) {
    PatchSeries series(kPatches, kFrames);
    for (std::uint32_t p = 0; p < kPatches; ++p)
      for (std::uint32_t f = 0; f < kFrames; ++f) series.at(p, f) = Rgb{1, 1, 1} * value(r, p, f);
    all.add(std::move(series));
  }
  return all;
}

TEST(Replicates, TheMeanIsTheirMean) {
  const auto mean =
      replicates_of([](auto r, auto p, auto f) { return static_cast<float>(4 * r + p + f); }).mean();
  for (std::uint32_t p = 0; p < kPatches; ++p)
    for (std::uint32_t f = 0; f < kFrames; ++f)
      ASSERT_FLOAT_EQ(mean.at(p, f).g, static_cast<float>(6 + p + f));
}

TEST(Replicates, EqualOnesHaveNoNoise) {
  const auto all = replicates_of([](auto, auto p, auto f) { return static_cast<float>((p * f) % 8); });
  for (const float noise : all.noise_in_time(all.mean())) ASSERT_EQ(noise, 0);
}

// Each replicate off by a constant of its own: that moves no key-frame.
TEST(Replicates, WhatIsCommonToAllFramesIsLeftOut) {
  const auto all =
      replicates_of([](auto r, auto p, auto f) { return static_cast<float>(8 * r + p % 4 + f); });
  for (const float noise : all.noise_in_time(all.mean())) ASSERT_NEAR(noise, 0, 1e-5);
}

// Independent normal deviates of spread s: the standard error of the mean of 4 is s / 2. One patch has
// 3 x 39 degrees of freedom, a relative spread of sqrt(1 / 234) = 6.5 %; the mean square over 200 patches
// 0.92 %, twice that of its root: five of those.
TEST(Replicates, NoiseIsTheStandardErrorOfTheMean) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 0.3f);
  const auto all = replicates_of([&](auto, auto, auto f) { return static_cast<float>(f) + normal(random); });
  double squares = 0;
  for (const float noise : all.noise_in_time(all.mean())) {
    EXPECT_NEAR(noise, 0.15, 5 * 0.065 * 0.15);
    squares += double{noise} * noise / kPatches;
  }
  EXPECT_NEAR(squares, 0.15 * 0.15, 5 * 0.0092 * 0.15 * 0.15);
}

TEST(Replicates, TheLargestChannelCounts) {
  Replicates all;
  for (const float sign : {-1.0f, 1.0f}) {
    PatchSeries series(1, 2);
    series.at(0, 0) = {0, 0.1f * sign, 1.0f * sign};
    series.at(0, 1) = {0, -0.1f * sign, -1.0f * sign};
    all.add(std::move(series));
  }
  // Deviations of blue: 1 in two frames of two replicates, one degree of freedom; sqrt(4 / 1 / 2).
  EXPECT_FLOAT_EQ(all.noise_in_time(all.mean())[0], std::sqrt(2.0f));
}

}  // namespace
}  // namespace engine
