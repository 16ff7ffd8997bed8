#include "engine/keyframes/fewest_key_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using Keys = std::vector<FrameIndex>;
using tests::series;
using tests::Squares;

Keys fewest(const PatchSeries& radiosity, double tolerance, const Keys& forced = {},
            std::vector<float> noise = {}) {
  const Squares world(radiosity.patch_count, radiosity.frame_count);
  InterpolationError error(world.lit(), radiosity, radiosity, std::move(noise));
  return *fewest_key_frames(error, tolerance, forced, Progress{});
}

TEST(FewestKeyFrames, StopsWhenToldTo) {
  const auto jumpy = series(1, 40, [](auto, auto f) { return f % 2 == 0 ? 1.0f : 2.0f; });
  const Squares world(1, 40);
  InterpolationError error(world.lit(), jumpy, jumpy);
  const auto keys = fewest_key_frames(error, 0.01, {}, {[](double) {}, [] { return true; }});
  ASSERT_FALSE(keys);
  EXPECT_EQ(keys.error().fault, api::Fault::stopped);
}

TEST(FewestKeyFrames, AStaticSequenceAndARampNeedFirstAndLastOnly) {
  EXPECT_EQ(fewest(series(3, 40, [](auto, auto) { return 2.0f; }), 0.01), (Keys{0, 39}));
  EXPECT_EQ(fewest(series(3, 40, [](auto p, auto f) { return 1 + 0.1f * static_cast<float>(p * f); }), 0.01),
            (Keys{0, 39}));
}

TEST(FewestKeyFrames, ADarkSequenceNeedsFirstAndLastOnly) {
  EXPECT_EQ(fewest(series(2, 10, [](auto, auto) { return 0.0f; }), 0.01), (Keys{0, 9}));
}

TEST(FewestKeyFrames, OneFrameIsOneKeyAndTwoAreTwo) {
  EXPECT_EQ(fewest(series(1, 1, [](auto, auto) { return 1.0f; }), 0.01), (Keys{0}));
  EXPECT_EQ(fewest(series(1, 2, [](auto, auto f) { return f == 0 ? 1.0f : 9.0f; }), 0.01), (Keys{0, 1}));
}

// The knots are the keys: without one of them its neighbours would miss by far more than 0.1 %.
TEST(FewestKeyFrames, OfAPiecewiseLinearSeriesAreItsKnots) {
  const std::vector<std::pair<std::uint32_t, float>> knots{{0, 1}, {7, 4}, {8, 1}, {20, 3}, {33, 2}, {39, 5}};
  const auto bent =
      series(3, 40, [&](auto p, auto f) { return p == 1 ? tests::through_knots(knots, f) : 2.0f; });
  EXPECT_EQ(fewest(bent, 1e-3), (Keys{0, 7, 8, 20, 33, 39}));
}

TEST(FewestKeyFrames, KnotsOfSeveralPatchesAreUnited) {
  const auto bent = series(2, 30, [&](auto p, auto f) {
    return tests::through_knots({{0, 1}, {p == 0 ? 9u : 17u, 3}, {29, 1}}, f);
  });
  EXPECT_EQ(fewest(bent, 1e-3), (Keys{0, 9, 17, 29}));
}

TEST(FewestKeyFrames, AJumpIsBothFramesAroundIt) {
  const auto jump = series(1, 20, [](auto, auto f) { return f < 12 ? 1.0f : 2.0f; });
  EXPECT_EQ(fewest(jump, 0.01), (Keys{0, 11, 12, 19}));
}

TEST(FewestKeyFrames, ForcedFramesAreKeysInAnyCase) {
  const auto constant = series(1, 20, [](auto, auto) { return 1.0f; });
  EXPECT_EQ(fewest(constant, 0.01, {4, 5, 13}), (Keys{0, 4, 5, 13, 19}));
  EXPECT_EQ(fewest(constant, 0.01, {0, 19}), (Keys{0, 19}));
}

TEST(FewestKeyFrames, IntervalsThatCannotBeWholeAreAtMost128Frames) {
  const auto constant = series(1, 400, [](auto, auto) { return 1.0f; });
  EXPECT_EQ(fewest(constant, 0.01), (Keys{0, 399}));
  const Keys keys = fewest(constant, 0.01, {1});
  EXPECT_EQ(keys.front(), 0u);
  EXPECT_EQ(keys.back(), 399u);
  EXPECT_EQ(keys.size(), 6u);  // 0, 1 and 398 frames in four intervals
  for (std::size_t k = 1; k < keys.size(); ++k) EXPECT_LE(keys[k] - keys[k - 1], 128u);
}

/// The fewest keys by trying every set of them.
std::size_t fewest_by_force(const InterpolationError& error, std::uint32_t frames, double tolerance) {
  std::size_t best = frames;
  for (std::uint32_t chosen = 0; chosen < (1u << (frames - 2)); ++chosen) {
    Keys keys{0};
    for (std::uint32_t f = 1; f + 1 < frames; ++f)
      if ((chosen >> (f - 1)) & 1) keys.push_back(f);
    keys.push_back(frames - 1);
    if (keys.size() >= best) continue;
    bool holds = true;
    for (std::size_t k = 1; k < keys.size() && holds; ++k)
      holds = error.largest(keys[k - 1], keys[k]) <= tolerance;
    if (holds) best = keys.size();
  }
  return best;
}

TEST(FewestKeyFrames, NoOtherSetOfFewerKeysKeepsTheToleranceOnRandomSeries) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> step(-0.3f, 0.3f);
  constexpr std::uint32_t kFrames = 11;
  std::size_t different = 0;
  for (int k = 0; k < 60; ++k) {
    float now = 2;
    const auto wandering =
        series(2, kFrames, [&](auto, auto f) { return now = f == 0 ? 2 : now + step(random); });
    const Squares world(2, kFrames);
    InterpolationError error(world.lit(), wandering, wandering);
    for (const double tolerance : {0.02, 0.1}) {
      const Keys keys = *fewest_key_frames(error, tolerance, {}, Progress{});
      for (std::size_t i = 1; i < keys.size(); ++i) ASSERT_LE(error.largest(keys[i - 1], keys[i]), tolerance);
      ASSERT_EQ(keys.size(), fewest_by_force(error, kFrames, tolerance)) << "case " << k;
      different += keys.size() > 2 && keys.size() < kFrames ? 1 : 0;
    }
  }
  EXPECT_GT(different, 40u);
}

// 40 frames x 8 patches of independent noise of 10 %: each of the roughly 300 tests of the whole interval is
// against four standard errors (one in 16,000 by chance); this seed's noise stays within.
TEST(FewestKeyFrames, PureNoiseOfAKnownSizeNeedsFirstAndLastOnly) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.1f);
  const auto noisy = series(8, 40, [&](auto, auto) { return 1 + noise(random); });
  EXPECT_EQ(fewest(noisy, 0.01, {}, std::vector<float>(8, 0.1f)), (Keys{0, 39}));
  EXPECT_GT(fewest(noisy, 0.01).size(), 30u);  // taken for light it would cost nearly every frame
}

TEST(FewestKeyFrames, AJumpThatStandsOutOfTheNoiseIsStillFound) {
  std::mt19937 random(6);
  std::normal_distribution<float> noise(0, 0.02f);
  const auto noisy =
      series(4, 40, [&](auto p, auto f) { return 1 + noise(random) + (p == 2 && f >= 20 ? 1 : 0); });
  const Keys keys = fewest(noisy, 0.05, {}, std::vector<float>(4, 0.02f));
  EXPECT_LT(keys.size(), 8u);
  EXPECT_TRUE(std::find(keys.begin(), keys.end(), 19u) != keys.end());
  EXPECT_TRUE(std::find(keys.begin(), keys.end(), 20u) != keys.end());
}

}  // namespace
}  // namespace engine
