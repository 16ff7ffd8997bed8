#include "engine/keyframes/interpolation_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "engine/interpolate/interpolate.h"
#include "engine/keyframes/fewest_key_frames.h"
#include "tests/unit/engine/keyframes/hand_made.h"

namespace engine {
namespace {

using api::Interpolated;
using api::Interpolation;
using tests::estimate_of;
using tests::series;
using tests::Squares;
using Knots = std::vector<FrameIndex>;

/// An estimate and what is said of it.
struct Judged {
  const Estimate estimate;
  InterpolationError error;

  Judged(const tests::World& world, Estimate from)
      : estimate(std::move(from)), error(world.lit(), estimate, Interpolated::total) {}
  Judged(const Judged&) = delete;
};

// B = 2 everywhere but 3 in frame 1 of patch 0: |B^ - B| = 1 over B = 3; half the mean (about 1) is less.
TEST(InterpolationError, IsRelativeToTheRadiosityOfPatchAndFrame) {
  const Squares world(2, 5);
  const auto radiosity = series(2, 5, [](auto p, auto f) { return p == 0 && f == 1 ? 3.0f : 2.0f; });
  Judged of_total(world,
                  estimate_of(world, radiosity, [&](auto, auto p, auto f) { return radiosity.at(p, f).g; }));
  InterpolationError& error = of_total.error;
  const auto errors = error.largest(Knots{0, 4}, Interpolation::linear);
  EXPECT_EQ(errors[0], 0);
  EXPECT_NEAR(errors[1], 1.0 / 3, 1e-6);
  EXPECT_NEAR(errors[2], 0, 1e-6);
  EXPECT_NEAR(error.largest(Knots{0, 1, 4}, Interpolation::linear)[2], (2.0 / 3) / 2, 1e-6);
  EXPECT_TRUE(error.within(0, 4, 0.334, Evidence::likely));
  EXPECT_FALSE(error.within(0, 4, 0.333, Evidence::likely));
  EXPECT_TRUE(error.within(2, 3, 0, Evidence::surely));
}

// Mean B = (4 + 0) / 2 = 2: a dark patch is measured against 1.
TEST(InterpolationError, OfADarkPatchIsRelativeToHalfTheMean) {
  const Squares world(2, 3);
  const auto radiosity = series(2, 3, [](auto p, auto) { return p == 0 ? 4.0f : 0.0f; });
  const Estimate estimate =
      estimate_of(world, radiosity, [](auto, auto p, auto f) { return p == 1 && f == 1 ? 0.25f : 0.0f; });
  const InterpolationError error(world.lit(), estimate, Interpolated::total);
  EXPECT_NEAR(error.largest(Knots{0, 2}, Interpolation::linear)[1], 0.25, 1e-6);
}

TEST(InterpolationError, TheLargestChannelCounts) {
  const Squares world(1, 3);
  PatchSeries radiosity(1, 3);
  for (FrameIndex f = 0; f < 3; ++f) radiosity.at(0, f) = {1, 0.1f, 2};
  Estimate estimate = estimate_of(world, radiosity, [](auto, auto, auto) { return 0.0f; });
  tests::set_all(estimate, 0, 1, 0, {0.1f, -0.5f, 0.2f});
  const InterpolationError error(world.lit(), estimate, Interpolated::total);
  EXPECT_NEAR(error.largest(Knots{0, 2}, Interpolation::linear)[1], 0.25, 1e-6);
}

// A light of B = 1000 must not hide what happens on the walls.
TEST(InterpolationError, PatchesThatEmitDoNotCountInTheMean) {
  Scene scene = tests::squares(2);
  scene.materials.push_back(scene.materials[0]);
  scene.polygons[0].material = 1;
  Animation animation = tests::still(scene, 3);
  animation.emission.exitance_w_m2[1] = {{}, {1000, 0, 0}, {}};
  const tests::World world(scene, animation, 1.0);
  const auto radiosity = series(2, 3, [](auto p, auto) { return p == 0 ? 1000.0f : 2.0f; });
  const Estimate estimate =
      estimate_of(world, radiosity, [](auto, auto p, auto f) { return p == 1 && f == 1 ? 1.0f : 0.0f; });
  const InterpolationError error(world.lit(), estimate, Interpolated::total);
  EXPECT_NEAR(error.largest(Knots{0, 2}, Interpolation::linear)[1], 0.5, 1e-6);
}

// B^ - B = rho scale (Y^ - Y): the squares reflect a half, and the group shines with .2 in frame 1.
TEST(InterpolationError, OfIndirectLightIsReflectedAndScaledInTheFrameItself) {
  const Squares world(1, 3);
  const auto radiosity = series(1, 3, [](auto, auto) { return 1.0f; });
  Estimate estimate = estimate_of(world, radiosity, [](auto, auto, auto f) { return f == 1 ? 3.0f : 0.0f; });
  const Knots ends{0, 2};
  EXPECT_NEAR(InterpolationError(world.lit(), estimate, Interpolated::indirect)
                  .largest(ends, Interpolation::linear)[1],
              1.5, 1e-6);
  estimate.groups[0].group.scale = {{1, 1, 1}, {0.2f, 0.2f, 0.2f}, {1, 1, 1}};
  EXPECT_NEAR(InterpolationError(world.lit(), estimate, Interpolated::indirect)
                  .largest(ends, Interpolation::linear)[1],
              0.3, 1e-6);
  EXPECT_NEAR(
      InterpolationError(world.lit(), estimate, Interpolated::total).largest(ends, Interpolation::linear)[1],
      3, 1e-6);
}

// Two groups that miss by the same in opposite directions miss nothing together.
TEST(InterpolationError, GroupsOfLightsAreAddedBeforeTheyAreJudged) {
  const Squares world(1, 3);
  const auto radiosity = series(1, 3, [](auto, auto) { return 1.0f; });
  Estimate estimate = estimate_of(world, radiosity, [](auto, auto, auto) { return 0.0f; });
  estimate.groups.push_back(estimate.groups[0]);
  estimate.interpolated = ReplicateSeries(1, 3, 2);
  for (const std::uint32_t group : {0u, 1u})
    for (FrameIndex f = 0; f < 3; ++f)
      tests::set_all(estimate, 0, f, group, Rgb{1, 1, 1} * (f == 1 ? 3.0f : 1.0f));
  InterpolationError twice(world.lit(), estimate, Interpolated::indirect);
  EXPECT_NEAR(twice.largest(Knots{0, 2}, Interpolation::linear)[1], 2, 1e-6);
  EXPECT_FALSE(twice.within(0, 2, 1.99, Evidence::likely));
  tests::set_all(estimate, 0, 1, 1, {-1, -1, -1});
  InterpolationError none(world.lit(), estimate, Interpolated::indirect);
  EXPECT_NEAR(none.largest(Knots{0, 2}, Interpolation::linear)[1], 0, 1e-6);
  EXPECT_TRUE(none.within(0, 2, 1e-6, Evidence::surely));
}

/// Waves with noise of this standard deviation in every replicate, patch and frame.
Estimate noisy_waves(const tests::World& world, float noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, 1);
  const std::uint32_t frames = world.animation.frame_count;
  const auto wave = [](auto p, auto f) {
    return 2 + 0.3f * std::sin(0.3f * static_cast<float>(f) * static_cast<float>(p + 1));
  };
  const auto radiosity = series(world.patches.count(), frames, wave);
  return estimate_of(world, radiosity,
                     [&](auto, auto p, auto f) { return wave(p, f) + noise * normal(random); });
}

TEST(InterpolationError, WithinIsLargestAgainstTheTolerance) {
  const Squares world(5, 30);
  Judged waves(world, noisy_waves(world, 0, 1));
  InterpolationError& error = waves.error;
  for (FrameIndex a = 0; a < 29; ++a)
    for (FrameIndex b = a + 1; b < 30; ++b) {
      Knots knots{a, b};
      if (a > 0) knots.insert(knots.begin(), 0);
      if (b < 29) knots.push_back(29);
      const auto errors = error.largest(knots, Interpolation::linear);
      const double between = *std::max_element(errors.begin() + a, errors.begin() + b + 1);
      for (const double tolerance : {0.01, 0.05, 0.2}) {
        if (std::abs(between - tolerance) < 1e-5) continue;  // either may be right
        ASSERT_EQ(error.within(a, b, tolerance, Evidence::likely), between <= tolerance) << a << " " << b;
      }
    }
}

TEST(InterpolationError, WhatIsWithinSeemsSoAndWhatWasRefusedDoesNotSeemSoAgain) {
  const Squares world(2, 30);
  Judged waves(world, noisy_waves(world, 0.01f, 3));
  InterpolationError& error = waves.error;
  EXPECT_TRUE(error.seems_within(0, 29, 0.001, Evidence::likely)) << "no patch has refused yet";
  int within = 0, refused = 0;
  for (FrameIndex a = 0; a < 28; ++a)
    for (FrameIndex b = a + 2; b < 30; ++b) {
      const bool is = error.within(a, b, 0.1, Evidence::likely);
      ASSERT_EQ(error.seems_within(a, b, 0.1, Evidence::likely), is) << a << " " << b;
      (is ? within : refused) += 1;
    }
  EXPECT_GT(within, 20);
  EXPECT_GT(refused, 20);
}

TEST(InterpolationError, WhatIsSurelyWithinIsLikelyAndWhatIsLikelyIsHardlyDenied) {
  const Squares world(3, 20);
  Judged waves(world, noisy_waves(world, 0.05f, 2));
  InterpolationError& error = waves.error;
  std::array<int, 3> held{};
  for (FrameIndex a = 0; a < 19; ++a)
    for (FrameIndex b = a + 1; b < 20; ++b)
      for (const double tolerance : {0.02, 0.05, 0.1}) {
        const bool surely = error.within(a, b, tolerance, Evidence::surely);
        const bool likely = error.within(a, b, tolerance, Evidence::likely);
        const bool hardly = error.within(a, b, tolerance, Evidence::hardly);
        ASSERT_TRUE(!surely || likely) << a << " " << b;
        ASSERT_TRUE(!likely || hardly) << a << " " << b;
        held[0] += surely ? 1 : 0;
        held[1] += likely ? 1 : 0;
        held[2] += hardly ? 1 : 0;
      }
  EXPECT_LT(held[0], held[1] - 20);
  EXPECT_LT(held[1], held[2] - 20);
}

// Noise alone, standard deviation .1 per replicate: the mean of 8 misses by about .04 here and there, but
// never by 3.9 of its standard errors (t of 7 degrees: 1 of 330; 8 patches x 8 frames are 64 looks, of
// which .2 may do so by chance; this seed does not).
TEST(InterpolationError, PureNoiseHardlyMissesAnything) {
  const Squares world(8, 10);
  std::mt19937 random(4);
  std::normal_distribution<float> normal(0, 0.1f);
  const auto radiosity = series(8, 10, [](auto, auto) { return 1.0f; });
  const Estimate estimate =
      estimate_of(world, radiosity, [&](auto, auto, auto) { return 1 + normal(random); });
  InterpolationError error(world.lit(), estimate, Interpolated::total);
  EXPECT_TRUE(error.within(0, 9, 0.001, Evidence::hardly));
  EXPECT_FALSE(error.within(0, 9, 0.02, Evidence::likely));
  EXPECT_FALSE(error.within(0, 9, 0.1, Evidence::surely));
}

// Each replicate is off by as much in every frame: interpolation does not care, so there is no noise.
TEST(InterpolationError, NoiseThatIsCommonToAllFramesIsNone) {
  const Squares world(2, 10);
  const auto radiosity = series(2, 10, [](auto, auto) { return 1.0f; });
  const Estimate estimate = estimate_of(
      world, radiosity, [](auto r, auto p, auto) { return 1 + 0.25f * static_cast<float>(r + p); });
  InterpolationError error(world.lit(), estimate, Interpolated::total);
  EXPECT_TRUE(error.within(0, 9, 1e-5, Evidence::surely));
}

TEST(InterpolationError, OfACubicIsThatOfTheCubic) {
  const Squares world(3, 20);
  const Judged waves(world, noisy_waves(world, 0, 1));
  const InterpolationError& error = waves.error;
  const Knots knots{0, 4, 8, 13, 19};
  const auto radiosity = series(3, 20, [](auto p, auto f) {
    return 2 + 0.3f * std::sin(0.3f * static_cast<float>(f) * static_cast<float>(p + 1));
  });
  const auto errors = error.largest(knots, Interpolation::monotone_cubic);
  const Interpolator cubic(knots, world.all_frames(), Interpolation::monotone_cubic);
  std::vector<double> expected(20, 0.0);
  for (PatchId p = 0; p < 3; ++p) {
    std::vector<Rgb> at_knots, found(20);
    for (const FrameIndex knot : knots) at_knots.push_back(radiosity.at(p, knot));
    cubic.apply(at_knots.data(), found.data());
    for (FrameIndex f = 0; f < 20; ++f)
      expected[f] = std::max(expected[f], std::abs(double{found[f].g} - radiosity.at(p, f).g) /
                                              std::max(radiosity.at(p, f).g, 1.0f));
  }
  for (FrameIndex f = 0; f < 20; ++f) EXPECT_NEAR(errors[f], expected[f], 1e-6) << f;
}

/// |x^ - x| of a wave about 2 at frames [first, last], by a cubic through the knots among these alone.
std::vector<double> missed_by_cubic(const Knots& knots, FrameIndex first, FrameIndex last) {
  const auto wave = [](FrameIndex f) { return 2 + std::sin(0.05f * static_cast<float>(f)); };
  Knots within, frames;
  std::vector<Rgb> at_knots;
  for (FrameIndex f = first; f <= last; ++f) frames.push_back(f);
  for (const FrameIndex knot : knots) {
    if (knot < first || knot > last) continue;
    within.push_back(knot);
    at_knots.push_back(Rgb{1, 1, 1} * wave(knot));
  }
  std::vector<Rgb> found(frames.size());
  Interpolator(within, frames, Interpolation::monotone_cubic).apply(at_knots.data(), found.data());
  std::vector<double> missed;
  for (const FrameIndex f : frames) missed.push_back(std::abs(found[f - first].g - wave(f)));
  return missed;
}

// Indirect light is interpolated window by window, all light over the whole sequence.
TEST(InterpolationError, OfACubicIsThatOfTheWindowsThatAreInterpolated) {
  const std::uint32_t frames = 2 * kIntervalMax + 30;
  const Squares world(1, frames);
  Knots knots;
  for (FrameIndex f = 0; f < frames; f += 10) knots.push_back(f);
  for (const FrameIndex f : {kIntervalMax, 2 * kIntervalMax, frames - 1}) knots.push_back(f);
  std::sort(knots.begin(), knots.end());
  const Estimate estimate =
      estimate_of(world, series(1, frames, [](auto, auto) { return 1.0f; }),
                  [](auto, auto, auto f) { return 2 + std::sin(0.05f * static_cast<float>(f)); });
  const auto errors = [&](Interpolated what) {
    return InterpolationError(world.lit(), estimate, what).largest(knots, Interpolation::monotone_cubic);
  };
  const auto of_indirect = errors(Interpolated::indirect), of_total = errors(Interpolated::total);
  const auto whole = missed_by_cubic(knots, 0, frames - 1);
  double seam = 0;
  for (FrameIndex f = 0; f < frames; ++f) {
    const FrameIndex first = f / kIntervalMax * kIntervalMax;
    const auto window = missed_by_cubic(knots, first, std::min(first + kIntervalMax, frames - 1));
    EXPECT_NEAR(of_indirect[f], 0.5 * window[f - first], 1e-6) << f;  // the squares reflect a half
    EXPECT_NEAR(of_total[f], whole[f], 1e-6) << f;
    seam = std::max(seam, std::abs(window[f - first] - whole[f]));
  }
  EXPECT_GT(seam, 1e-3) << "there is nothing to tell them apart by";
}

TEST(InterpolationError, ASceneWithoutLightHasNone) {
  const Squares world(1, 3);
  const Estimate estimate = estimate_of(world, PatchSeries(1, 3), [](auto, auto, auto) { return 0.0f; });
  InterpolationError error(world.lit(), estimate, Interpolated::total);
  EXPECT_EQ(error.largest(Knots{0, 2}, Interpolation::linear)[1], 0);
  EXPECT_TRUE(error.within(0, 2, 1e-9, Evidence::surely));
}

}  // namespace
}  // namespace engine
