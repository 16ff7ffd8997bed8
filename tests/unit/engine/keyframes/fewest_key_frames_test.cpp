#include "engine/keyframes/fewest_key_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using api::FrameIndex;
using Keys = std::vector<FrameIndex>;
using Curve = std::vector<float>;

/// Largest distance of the curve from its chord between two frames.
double missed(const Curve& curve, FrameIndex a, FrameIndex b) {
  double largest = 0;
  for (FrameIndex f = a + 1; f < b; ++f) {
    const double w = static_cast<double>(f - a) / (b - a);
    largest = std::max(largest, std::abs((1 - w) * curve[a] + w * curve[b] - double{curve[f]}));
  }
  return largest;
}

MaySkip within(const Curve& curve, double tolerance) {
  return [&curve, tolerance](FrameIndex a, FrameIndex b) { return missed(curve, a, b) <= tolerance; };
}

Keys fewest(const Curve& curve, double tolerance, const Keys& forced = {}) {
  return *fewest_key_frames(static_cast<std::uint32_t>(curve.size()), within(curve, tolerance), forced,
                            Progress{});
}

Curve curve_of(std::uint32_t frames, const std::function<float(std::uint32_t)>& value) {
  Curve curve;
  for (std::uint32_t f = 0; f < frames; ++f) curve.push_back(value(f));
  return curve;
}

TEST(FewestKeyFrames, StopsWhenToldTo) {
  const Curve jumpy = curve_of(40, [](auto f) { return f % 2 == 0 ? 1.0f : 2.0f; });
  const auto keys = fewest_key_frames(40, within(jumpy, 0.01), {}, {[](double) {}, [] { return true; }});
  ASSERT_FALSE(keys);
  EXPECT_EQ(keys.error().fault, api::Fault::stopped);
}

TEST(FewestKeyFrames, AConstantAndARampNeedFirstAndLastOnly) {
  EXPECT_EQ(fewest(Curve(40, 2.0f), 0.01), (Keys{0, 39}));
  EXPECT_EQ(fewest(curve_of(40, [](auto f) { return 0.5f * static_cast<float>(f); }), 0.01), (Keys{0, 39}));
}

TEST(FewestKeyFrames, OneFrameIsOneKeyAndTwoAreTwo) {
  EXPECT_EQ(fewest({1}, 0.01), (Keys{0}));
  EXPECT_EQ(fewest({1, 9}, 0.01), (Keys{0, 1}));
}

// The knots are the keys: without one of them its neighbours would miss by far more than 0.1 %.
TEST(FewestKeyFrames, OfAPiecewiseLinearSeriesAreItsKnots) {
  const std::vector<std::pair<std::uint32_t, float>> knots{{0, 1}, {7, 4}, {8, 1}, {20, 3}, {33, 2}, {39, 5}};
  const Curve bent = curve_of(40, [&](auto f) { return tests::through_knots(knots, f); });
  EXPECT_EQ(fewest(bent, 1e-3), (Keys{0, 7, 8, 20, 33, 39}));
}

TEST(FewestKeyFrames, AJumpIsBothFramesAroundIt) {
  EXPECT_EQ(fewest(curve_of(20, [](auto f) { return f < 12 ? 1.0f : 2.0f; }), 0.01), (Keys{0, 11, 12, 19}));
}

TEST(FewestKeyFrames, ForcedFramesAreKeysInAnyCase) {
  const Curve constant(20, 1.0f);
  EXPECT_EQ(fewest(constant, 0.01, {4, 5, 13}), (Keys{0, 4, 5, 13, 19}));
  EXPECT_EQ(fewest(constant, 0.01, {0, 19}), (Keys{0, 19}));
}

TEST(FewestKeyFrames, NoIntervalIsLongerThanItsLimit) {
  for (const std::uint32_t frames : {kIntervalMax, kIntervalMax + 1, kIntervalMax + 2, 400u}) {
    const Keys keys = fewest(Curve(frames, 1.0f), 0.01);
    EXPECT_EQ(keys.front(), 0u);
    EXPECT_EQ(keys.back(), frames - 1);
    EXPECT_EQ(keys.size(), 1 + (frames - 1 + kIntervalMax - 1) / kIntervalMax) << frames;
    for (std::size_t k = 1; k < keys.size(); ++k) EXPECT_LE(keys[k] - keys[k - 1], kIntervalMax);
  }
}

/// The fewest keys by trying every set of them that has the forced ones.
std::size_t fewest_by_force(const Curve& curve, double tolerance, const Keys& forced) {
  const auto frames = static_cast<std::uint32_t>(curve.size());
  std::size_t best = frames;
  for (std::uint32_t chosen = 0; chosen < (1u << (frames - 2)); ++chosen) {
    Keys keys{0};
    for (std::uint32_t f = 1; f + 1 < frames; ++f)
      if ((chosen >> (f - 1)) & 1) keys.push_back(f);
    keys.push_back(frames - 1);
    if (keys.size() >= best || !std::includes(keys.begin(), keys.end(), forced.begin(), forced.end()))
      continue;
    bool holds = true;
    for (std::size_t k = 1; k < keys.size() && holds; ++k)
      holds = missed(curve, keys[k - 1], keys[k]) <= tolerance;
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
    const Curve wandering = curve_of(kFrames, [&](auto) { return now += step(random); });
    const Keys forced = k % 3 == 0 ? Keys{static_cast<FrameIndex>(1 + random() % 9)} : Keys{};
    for (const double tolerance : {0.05, 0.2}) {
      const Keys keys = fewest(wandering, tolerance, forced);
      for (std::size_t i = 1; i < keys.size(); ++i)
        ASSERT_LE(missed(wandering, keys[i - 1], keys[i]), tolerance);
      ASSERT_TRUE(std::includes(keys.begin(), keys.end(), forced.begin(), forced.end()));
      ASSERT_EQ(keys.size(), fewest_by_force(wandering, tolerance, forced)) << "case " << k;
      different += keys.size() > 2 && keys.size() < kFrames ? 1 : 0;
    }
  }
  EXPECT_GT(different, 40u);
}

// Many curves, of which a few decide; the quick answer knows those that have refused.
TEST(FewestKeyFrames, AreTheSameByAQuickAnswerThatLearnsFromTheSlowOne) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> step(-0.3f, 0.3f);
  for (int k = 0; k < 20; ++k) {
    std::vector<Curve> curves;
    for (int c = 0; c < 12; ++c) {
      float now = 2;
      curves.push_back(curve_of(300, [&](auto) { return now += (c + k) % 4 == 0 ? step(random) : 0.001f; }));
    }
    std::vector<bool> known(curves.size(), false);
    std::size_t asked = 0;
    const auto refuses = [&](std::size_t c, FrameIndex a, FrameIndex b) {
      return missed(curves[c], a, b) > 0.4;
    };
    const MaySkip may_skip = [&](FrameIndex a, FrameIndex b) {
      ++asked;
      for (std::size_t c = 0; c < curves.size(); ++c)
        if (refuses(c, a, b)) {
          known[c] = true;
          return false;
        }
      return true;
    };
    const MaySkip seems_to = [&](FrameIndex a, FrameIndex b) {
      for (std::size_t c = 0; c < curves.size(); ++c)
        if (known[c] && refuses(c, a, b)) return false;
      return true;
    };
    const Keys forced = {17, 100};
    const auto quick = fewest_key_frames(300, seems_to, may_skip, forced, Progress{});
    ASSERT_TRUE(quick);
    const std::size_t asked_quick = std::exchange(asked, 0);
    EXPECT_EQ(*quick, *fewest_key_frames(300, may_skip, forced, Progress{}));
    EXPECT_LT(asked_quick, asked / 2);
    EXPECT_GT(quick->size(), 6u);
  }
}

TEST(FewestKeyFrames, NoIntervalIsAskedAboutTwiceNorAcrossAForcedFrame) {
  const Curve jumpy = curve_of(60, [](auto f) { return f % 2 == 0 ? 1.0f : 2.0f; });
  std::map<std::pair<FrameIndex, FrameIndex>, int> asked;
  const MaySkip may_skip = [&](FrameIndex a, FrameIndex b) {
    ++asked[{a, b}];
    return missed(jumpy, a, b) <= 0.01;
  };
  ASSERT_TRUE(fewest_key_frames(60, may_skip, {20}, Progress{}));
  for (const auto& [interval, times] : asked) {
    EXPECT_LE(times, 1);
    EXPECT_FALSE(interval.first < 20 && interval.second > 20);
  }
}

}  // namespace
}  // namespace engine
