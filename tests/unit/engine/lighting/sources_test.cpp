#include "engine/lighting/sources.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using tests::LitRoom;

constexpr std::uint32_t kPatches = 4'000, kReplicates = 8;

/// Variances .25, .01 and 0 in the mean of two frames.
DirectLight with_variance() {
  DirectLight direct;
  direct.variance = PatchSeries(kPatches, 2);
  for (PatchId patch = 0; patch < kPatches; ++patch) {
    direct.variance.at(patch, 0) = {0.5f, 0.01f, 0};
    direct.variance.at(patch, 1) = {0, 0.01f, 0};
  }
  return direct;
}

TEST(NoiseOfDirect, AddsUpToNothingOverEachBlockOfReplicates) {
  for (std::uint32_t block = 0; block < 2; ++block) {
    std::vector<float> sum(kPatches);
    for (std::uint32_t r = 0; r < kReplicates; ++r) {
      const auto noise = noise_of_direct(with_variance(), block * kReplicates + r, kReplicates, 5, 0);
      for (PatchId patch = 0; patch < kPatches; ++patch) sum[patch] += noise[patch];
    }
    for (const float value : sum) ASSERT_NEAR(value, 0, 1e-5);
  }
}

// In standard deviations: sum_r eta^2 / (N (N - 1)) over N replicates has the mean 1 and, of one block, as a
// chi-square of 7 degrees, a relative spread of sqrt(2 / 7) per patch, of several blocks less; over 4,000
// patches .85 %: five of those.
TEST(NoiseOfDirect, HasTheVarianceOfDirectLightInTheMeanHoweverManyBlocksThereAre) {
  double squares = 0;
  for (std::uint32_t block = 0; block < 4; ++block) {
    for (std::uint32_t r = 0; r < kReplicates; ++r)
      for (const float value : noise_of_direct(with_variance(), block * kReplicates + r, kReplicates, 5, 0))
        squares += double{value} * value / kPatches;
    const double count = (block + 1) * kReplicates;
    EXPECT_NEAR(squares / (count * (count - 1)), 1, 5 * 0.0085);
  }
}

// Products of independent ones are 0 in the mean of 4,000, give or take 1 / sqrt(4000) of their size, which
// is R (1 - 1/R) = 7.
TEST(NoiseOfDirect, IsIndependentBetweenPatchesBlocksSeedsAndGroups) {
  const auto a = noise_of_direct(with_variance(), 0, kReplicates, 5, 0);
  const auto expect_independent = [&](const std::vector<float>& b, PatchId step) {
    double product = 0;
    for (PatchId patch = 0; patch < kPatches; ++patch)
      product += double{a[patch]} * b[(patch + step) % kPatches] / kPatches;
    EXPECT_NEAR(product, 0, 5 * 7 / std::sqrt(kPatches));
  };
  expect_independent(a, 1);
  expect_independent(noise_of_direct(with_variance(), kReplicates, kReplicates, 5, 0), 0);
  expect_independent(noise_of_direct(with_variance(), 0, kReplicates, 6, 0), 0);
  expect_independent(noise_of_direct(with_variance(), 0, kReplicates, 5, 1), 0);
}

TEST(NoiseOfDirect, IsNoneWhereNoVarianceIsKnown) {
  EXPECT_TRUE(noise_of_direct(DirectLight{}, 0, 8, 1, 0).empty());
  EXPECT_TRUE(noise_of_direct(with_variance(), 0, 1, 1, 0).empty());
}

TEST(SourceAtRest, IsTheMeanOfWhatEmitsAndNothingOfWhatMoves) {
  LitRoom room(4);
  room.animation.emission.exitance_w_m2 = {{{}}, {{0, 0, 0}, {4, 0, 0}, {0, 8, 0}, {0, 0, 2}}, {{9, 9, 9}}};
  const GroupSource source{&room.animation.emission};
  const auto at_rest = source_at_rest(room.lit(), source, reflectance_at_rest(room.lit()));
  bool lamp = false;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
    const bool is_lamp = room.lit().material_of(patch) == 1;
    ASSERT_EQ(at_rest[patch], is_lamp ? (Rgb{1, 2, 0.5f}) : Rgb{}) << patch;
    lamp = lamp || is_lamp;
  }
  EXPECT_TRUE(lamp);
}

TEST(ReflectanceAtRest, IsTheMeanOfAllFramesAndNothingOfWhatMoves) {
  LitRoom room(4);
  room.animation.reflectance = {{{0.1f, 0, 0}, {0.2f, 0, 0}, {0.3f, 0, 0}, {0.4f, 0, 0.8f}}};
  const auto at_rest = reflectance_at_rest(room.lit());
  for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
    const std::uint32_t material = room.lit().material_of(patch);
    if (!room.lit().at_rest(patch))
      ASSERT_EQ(at_rest[patch], Rgb{});
    else if (material == 0) {
      ASSERT_NEAR(at_rest[patch].r, 0.25, 1e-6);
      ASSERT_NEAR(at_rest[patch].b, 0.2, 1e-6);
    } else {
      ASSERT_EQ(at_rest[patch], (Rgb{0.1f, 0.1f, 0.1f}));
    }
  }
}

}  // namespace
}  // namespace engine
