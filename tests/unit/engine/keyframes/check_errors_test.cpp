#include "engine/keyframes/check_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using tests::series;
using tests::Squares;
using Keys = std::vector<FrameIndex>;

/// Two squares of 1 m^2 in 10 x 10 patches each.
struct FineSquares : tests::World {
  FineSquares() : World(tests::squares(2), tests::still(tests::squares(2), 3), 0.1) {}
};

/// missed(replicate, patch) at one check.
ReplicateMean missed_by(std::uint32_t patches, std::uint32_t replicates,
                        const std::function<float(std::uint32_t, PatchId)>& missed) {
  ReplicateMean mean(patches, 1);
  for (std::uint32_t r = 0; r < replicates; ++r) {
    mean.begin();
    mean.add(series(patches, 1, [&](auto p, auto) { return missed(r, p); }), 0, 0);
  }
  return mean;
}

CheckedRadiosity uniform(std::uint32_t patches, float b, double mean) {
  return {series(patches, 1, [&](auto, auto) { return b; }), mean};
}

TEST(LeftOut, IsTheCheckInterpolatedFromTheKeysLessTheCheck) {
  const Squares world(2, 13);
  // Solved: 0, 2, 8, 10, 12; checks 2 and 10.
  const auto solved = series(2, 5, [](auto p, auto k) {
    return (p == 0 ? 1.0f : 0.0f) * std::array{1.0f, 2.0f, 3.0f, 4.0f, 5.0f}[k];
  });
  const PatchSeries* interpolated[] = {&solved};
  const PatchSeries missed =
      left_out(world.lit(), {}, interpolated, Keys{0, 8, 12}, Keys{2, 10}, api::Interpolation::linear);
  EXPECT_NEAR(missed.at(0, 0).g, 1.5 - 2, 1e-6);  // a quarter of the way from 1 to 3
  EXPECT_NEAR(missed.at(0, 1).g, 4 - 4, 1e-6);    // the middle of 3 and 5
  EXPECT_EQ(missed.at(1, 0), Rgb{});
}

// The squares reflect a half.
TEST(LeftOut, OfGroupsIsReflectedScaledAndAddedUp) {
  const Squares world(1, 5);
  const std::vector<LitGroup> groups{
      {{"a", world.animation.emission, {{1, 1, 1}, {0, 0, 0}, {0.2f, 1, 0}, {1, 1, 1}, {1, 1, 1}}}, {}},
      {{"b", world.animation.emission, {{1, 1, 1}}}, {}}};
  const auto bump = series(1, 3, [](auto, auto k) { return k == 1 ? 5.0f : 1.0f; });
  const auto dip = series(1, 3, [](auto, auto k) { return k == 1 ? 0.0f : 2.0f; });
  const PatchSeries* interpolated[] = {&bump, &dip};
  const Rgb missed =
      left_out(world.lit(), groups, interpolated, Keys{0, 4}, Keys{2}, api::Interpolation::linear).at(0, 0);
  EXPECT_NEAR(missed.r, 0.5 * (0.2 * -4 + 2), 1e-6);
  EXPECT_NEAR(missed.g, 0.5 * (1 * -4 + 2), 1e-6);
  EXPECT_NEAR(missed.b, 0.5 * 2, 1e-6);
}

TEST(CheckErrors, OfOneReplicateAreTakenAsTheyAre) {
  const Squares world(3, 3);
  const auto missed = missed_by(3, 1, [](auto, auto p) { return p == 1 ? -0.3f : 0.1f; });
  EXPECT_NEAR(check_errors(world.lit(), missed, uniform(3, 2, 2))[0], 0.15, 1e-6);
  EXPECT_NEAR(check_errors(world.lit(), missed, uniform(3, 0.5f, 2))[0], 0.3, 1e-6);  // half the mean
  EXPECT_EQ(check_errors(world.lit(), missed, uniform(3, 0, 0))[0], 0) << "without light";
}

// Standard normal deviates: their mean has a standard error of 1 / sqrt(8) = .35, and of 200 patches it is
// beyond 1 in some. Single patches may have small scatter by chance; those of a facet together do not.
TEST(CheckErrors, PureNoiseIsNoError) {
  const FineSquares world;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    const auto missed = missed_by(200, 8, [&](auto, auto) { return normal(random); });
    EXPECT_EQ(check_errors(world.lit(), missed, uniform(200, 1, 1))[0], 0) << seed;
  }
}

TEST(CheckErrors, AMissThatStandsOutOfTheNoiseIsSeen) {
  const FineSquares world;
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 0.1f);
  const auto missed =
      missed_by(200, 8, [&](auto, auto p) { return (p == 137 ? 0.5f : 0.0f) + normal(random); });
  // .5, known to .035, less five standard errors of at least that (the facet's) and seldom 1.6 times that.
  const double error = check_errors(world.lit(), missed, uniform(200, 1, 1))[0];
  EXPECT_LT(error, 0.5 + 3 * 0.035 - 5 * 0.035 * 0.95);
  EXPECT_GT(error, 0.5 - 3 * 0.035 - 5 * 0.035 * 1.6);
}

/// +-s in turn on the patches of `noisy`: a standard error of s sqrt(8 / 56) = .378 s; .2 missed by patch 3.
double error_with_noise_on(const std::function<bool(PatchId)>& noisy, float s) {
  const FineSquares world;
  const auto missed = missed_by(200, 8, [&](auto r, auto p) {
    return (p == 3 ? 0.2f : 0.0f) + (noisy(p) ? (r % 2 == 0 ? s : -s) : 0.0f);
  });
  return check_errors(world.lit(), missed, uniform(200, 1, 1))[0];
}

TEST(CheckErrors, TheNoiseIsThatOfThePatchOrOfItsFacetWhereThatIsMore) {
  const double unit = std::sqrt(1.0 / 7);
  EXPECT_NEAR(error_with_noise_on([](PatchId) { return false; }, 0), 0.2, 1e-6);
  EXPECT_NEAR(error_with_noise_on([](PatchId p) { return p < 100; }, 0.05f), 0.2 - 5 * 0.05 * unit, 1e-5);
  EXPECT_NEAR(error_with_noise_on([](PatchId p) { return p == 3; }, 0.05f), 0.2 - 5 * 0.05 * unit, 1e-5);
  // Of the 99 others: a root mean square of sqrt(.99) of theirs.
  EXPECT_NEAR(error_with_noise_on([](PatchId p) { return p != 3 && p < 100; }, 0.05f),
              0.2 - 5 * 0.05 * unit * std::sqrt(0.99), 1e-5);
  EXPECT_NEAR(error_with_noise_on([](PatchId p) { return p >= 100; }, 0.05f), 0.2, 1e-5) << "another facet";
}

KeyFrames chosen(Keys keys, Keys checks) {
  KeyFrames all;
  all.keys = std::move(keys);
  all.checks = std::move(checks);
  merge_solved(all);
  return all;
}

TEST(Split, LeavesWhatIsGoodAsItIs) {
  KeyFrames all = chosen({0, 8, 20}, {4, 14});
  EXPECT_FALSE(split(all, {false, false}));
  EXPECT_EQ(all.keys, (Keys{0, 8, 20}));
  EXPECT_EQ(all.checks, (Keys{4, 14}));
}

TEST(Split, MakesABadCheckAKeyWithChecksInTheHalves) {
  KeyFrames all = chosen({0, 8, 18}, {4, 13});
  EXPECT_TRUE(split(all, {false, true}));
  EXPECT_EQ(all.keys, (Keys{0, 8, 13, 18}));
  EXPECT_EQ(all.checks, (Keys{4, 10, 15}));
  EXPECT_EQ(all.solved, (Keys{0, 4, 8, 10, 13, 15, 18}));
}

TEST(Split, OfTwoChecksOneThatIsBadMakesBothKeys) {
  for (const bool first : {true, false}) {
    KeyFrames all = chosen({0, 12, 30, 31}, {4, 8, 18, 24});
    EXPECT_TRUE(split(all, {first, !first, false, false}));
    EXPECT_EQ(all.keys, (Keys{0, 4, 8, 12, 30, 31}));
    EXPECT_EQ(all.checks, (Keys{2, 6, 10, 18, 24}));
  }
}

// All would be solved again to the same frames.
TEST(Split, EndsWhereAllFramesAreSolved) {
  KeyFrames all = chosen({0, 2, 5}, {1, 3});
  EXPECT_TRUE(split(all, {true, true}));
  EXPECT_EQ(all.keys, (Keys{0, 2, 3, 5}));
  EXPECT_EQ(all.checks, (Keys{1, 4}));
  EXPECT_EQ(all.solved, (Keys{0, 1, 2, 3, 4, 5}));
  EXPECT_FALSE(split(all, {true, true}));
  EXPECT_EQ(all.keys, (Keys{0, 2, 3, 5}));
  EXPECT_EQ(all.checks, (Keys{1, 4}));
}

}  // namespace
}  // namespace engine
