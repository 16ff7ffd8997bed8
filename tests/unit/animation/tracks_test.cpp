// Values between keys.
#include "engine/animation/tracks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engine {
namespace {

using api::KeyInterpolation;
using NumberTrack = api::Track<double>;

NumberTrack track_of(KeyInterpolation interpolation, std::vector<NumberTrack::Key> keys) {
  return {interpolation, std::move(keys)};
}

constexpr std::array kAllKinds{KeyInterpolation::linear, KeyInterpolation::cubic, KeyInterpolation::step};

TEST(Tracks, PassThroughTheirKeysAndHoldTheirEnds) {
  for (const KeyInterpolation kind : kAllKinds) {
    const auto track = track_of(kind, {{3, 0.1}, {5, -7.3}, {6, 2.9}, {20, 11.7}});
    for (const auto& key : track.keys) EXPECT_EQ(value_at(track, key.frame, 99), key.value);
    EXPECT_EQ(value_at(track, 0, 99), 0.1);
    EXPECT_EQ(value_at(track, 1000, 99), 11.7);
  }
}

TEST(Tracks, ThatAreNotGivenHaveTheMissingValue) {
  EXPECT_EQ(value_at(NumberTrack{}, 4, 99), 99);
  EXPECT_TRUE(value_at(api::Track<bool>{}, 4, true));
}

TEST(Tracks, WithOneKeyAreConstant) {
  for (const KeyInterpolation kind : kAllKinds)
    for (const api::FrameIndex frame : {0u, 3u, 9u})
      EXPECT_EQ(value_at(track_of(kind, {{3, 2.5}}), frame, 0), 2.5);
}

TEST(LinearTracks, DivideTheWayEvenly) {
  const auto track = track_of(KeyInterpolation::linear, {{10, 1}, {14, 3}});
  EXPECT_DOUBLE_EQ(value_at(track, 11, 0), 1.5);
  EXPECT_DOUBLE_EQ(value_at(track, 12, 0), 2);
  EXPECT_DOUBLE_EQ(value_at(track, 13, 0), 2.5);
}

TEST(StepTracks, HoldUntilTheNextKey) {
  const auto track = track_of(KeyInterpolation::step, {{10, 1}, {14, 3}});
  EXPECT_EQ(value_at(track, 13, 0), 1);
  EXPECT_EQ(value_at(track, 14, 0), 3);
}

// Between equal keys the spline is the cubic Hermite of Catmull-Rom: at the middle of b and c it is
// (-a + 9 b + 9 c - d) / 16.
TEST(CubicTracks, AreCatmullRomForEvenKeys) {
  const auto track = track_of(KeyInterpolation::cubic, {{0, 1}, {2, 4}, {4, -2}, {6, 7}});
  EXPECT_DOUBLE_EQ(value_at(track, 3, 0), (-1 + 9 * 4 + 9 * -2 - 7) / 16.0);
}

TEST(CubicTracks, ReproduceAParabolaBetweenInnerKeysWhateverTheirSpacing) {
  const auto parabola = [](double t) { return 3 - 2 * t + 0.25 * t * t; };
  NumberTrack track{KeyInterpolation::cubic, {}};
  for (const api::FrameIndex frame : {0u, 3u, 4u, 11u, 30u}) track.keys.push_back({frame, parabola(frame)});
  for (api::FrameIndex frame = 3; frame <= 11; ++frame)
    EXPECT_NEAR(value_at(track, frame, 0), parabola(frame), 1e-12) << frame;
  EXPECT_GT(std::abs(value_at(track, 1, 0) - parabola(1)), 0.1) << "the ends know one neighbour only";
}

TEST(CubicTracks, WithTwoKeysAreStraight) {
  const auto track = track_of(KeyInterpolation::cubic, {{0, 1}, {4, 3}});
  EXPECT_DOUBLE_EQ(value_at(track, 1, 0), 1.5);
}

TEST(BooleanTracks, AreStepsWhateverTheySay) {
  const api::Track<bool> track{KeyInterpolation::linear, {{2, false}, {5, true}}};
  EXPECT_FALSE(value_at(track, 0, true));
  EXPECT_FALSE(value_at(track, 4, true));
  EXPECT_TRUE(value_at(track, 5, true));
}

}  // namespace
}  // namespace engine
