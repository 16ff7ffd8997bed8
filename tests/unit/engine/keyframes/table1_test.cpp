#include "engine/keyframes/table1.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using Keys = std::vector<FrameIndex>;
using tests::series;

/// Of one patch of 1 m^2, so that power [W] is radiosity [W/m^2] in number.
Keys keys_of(const PatchSeries& radiosity, double epsilon, LastKey last_key) {
  const tests::Squares world(radiosity.patch_count, radiosity.frame_count);
  return table1_key_frames(world.lit(), radiosity, api::Table1Metric::power, epsilon, last_key);
}

TEST(Table1, AConstantSeriesNeedsItsFirstAndLastFrame) {
  const auto constant = series(2, 20, [](auto, auto) { return 3.0f; });
  EXPECT_EQ(keys_of(constant, 0.1, LastKey::marked), (Keys{0, 19}));
  EXPECT_EQ(keys_of(constant, 0.1, LastKey::lost), (Keys{0, 19}));
}

// Steps of 1/4 W against 0.6 W: the third frame after a key is the first that differs by more.
TEST(Table1, ARampCostsManyKeys) {
  const auto ramp = series(1, 12, [](auto, auto f) { return 0.25f * static_cast<float>(f); });
  EXPECT_EQ(keys_of(ramp, 0.6, LastKey::marked), (Keys{0, 3, 6, 9, 11}));
  EXPECT_EQ(keys_of(ramp, 0.6, LastKey::lost), (Keys{0, 3, 6, 11}));  // 9 was found last, and is lost
}

TEST(Table1, AJumpIsOneKeyAndLostWhereTheLastOneIs) {
  const auto jump = series(1, 10, [](auto, auto f) { return f < 5 ? 1.0f : 2.0f; });
  EXPECT_EQ(keys_of(jump, 0.5, LastKey::marked), (Keys{0, 5, 9}));
  EXPECT_EQ(keys_of(jump, 0.5, LastKey::lost), (Keys{0, 9}));
}

TEST(Table1, OfTwoJumpsTheSecondIsLost) {
  const auto jumps = series(1, 12, [](auto, auto f) { return f < 4 ? 1.0f : f < 8 ? 2.0f : 3.0f; });
  EXPECT_EQ(keys_of(jumps, 0.5, LastKey::marked), (Keys{0, 4, 8, 11}));
  EXPECT_EQ(keys_of(jumps, 0.5, LastKey::lost), (Keys{0, 4, 11}));
}

TEST(Table1, FramesAreComparedWithTheLastKeyAndNotWithTheFrameBefore) {
  const auto back_and_forth = series(1, 9, [](auto, auto f) { return f == 4 ? 2.0f : 1.0f; });
  EXPECT_EQ(keys_of(back_and_forth, 0.5, LastKey::marked), (Keys{0, 4, 5, 8}));
}

TEST(Table1, ADifferenceOfExactlyEpsilonIsNone) {
  const auto jump = series(1, 10, [](auto, auto f) { return f < 5 ? 1.0f : 1.5f; });
  EXPECT_EQ(keys_of(jump, 0.5, LastKey::marked), (Keys{0, 9}));
  EXPECT_EQ(keys_of(jump, 0.4999, LastKey::marked), (Keys{0, 5, 9}));
}

TEST(Table1, OnePatchOfManyIsEnough) {
  const auto one = series(50, 10, [](auto p, auto f) { return p == 37 && f >= 6 ? 9.0f : 1.0f; });
  EXPECT_EQ(keys_of(one, 0.5, LastKey::marked), (Keys{0, 6, 9}));
}

TEST(Table1, PowerIsAreaTimesTheLargestChannel) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {0, 1, 0}});
  const tests::World world(scene, tests::still(scene, 9), 10);
  PatchSeries radiosity(1, 9);
  const auto keys = [&](double epsilon) {
    return table1_key_frames(world.lit(), radiosity, api::Table1Metric::power, epsilon, LastKey::marked);
  };
  for (FrameIndex f = 0; f < 9; ++f) radiosity.at(0, f) = f < 3 ? Rgb{1, 0.5f, 0} : Rgb{1, 0.9f, 0.9f};
  EXPECT_EQ(keys(0.1), (Keys{0, 8}));  // red stays
  for (FrameIndex f = 6; f < 9; ++f) radiosity.at(0, f) = {1.2f, 0, 0};
  EXPECT_EQ(keys(0.7), (Keys{0, 6, 8}));  // 4 m^2 x 0.2
  EXPECT_EQ(keys(0.9), (Keys{0, 8}));
}

/// Keys of a series in a world where nothing emits.
Keys keys_by(api::Table1Metric metric, const PatchSeries& radiosity, double edge_m, double epsilon) {
  Scene scene = tests::scene_with(1, 1);
  const auto width = static_cast<float>(edge_m);
  for (std::uint32_t k = 0; k < radiosity.patch_count; ++k) {
    const float x = 2 * width * static_cast<float>(k);
    tests::add_polygon(scene, {{x, 0, 0}, {x + width, 0, 0}, {x + width, width, 0}, {x, width, 0}});
  }
  const tests::World world(scene, tests::still(scene, radiosity.frame_count), 2 * edge_m);
  return table1_key_frames(world.lit(), radiosity, metric, epsilon, LastKey::marked);
}

// Steps of 1 W/m^2: on 1/4 m^2 those are 1/4 W.
TEST(Table1, RadiosityDoesNotDependOnTheSizeOfPatchesAndPowerDoes) {
  const auto steps = series(1, 9, [](auto, auto f) { return 1.0f + static_cast<float>(f / 3); });
  for (const double edge : {0.5, 4.0}) {
    EXPECT_EQ(keys_by(api::Table1Metric::radiosity, steps, edge, 0.9), (Keys{0, 3, 6, 8})) << edge;
    EXPECT_EQ(keys_by(api::Table1Metric::radiosity, steps, edge, 1.1), (Keys{0, 6, 8})) << edge;
  }
  EXPECT_EQ(keys_by(api::Table1Metric::power, steps, 0.5, 0.9), (Keys{0, 8}));
  EXPECT_EQ(keys_by(api::Table1Metric::power, steps, 0.5, 0.4), (Keys{0, 6, 8}));
  EXPECT_EQ(keys_by(api::Table1Metric::power, steps, 4.0, 15), (Keys{0, 3, 6, 8}));
}

// From 2 to 3 is a third of the brighter frame, however bright the scale; so is from 3 to 2.
TEST(Table1, RelativeIsMeasuredAgainstTheBrighterOfBothFrames) {
  for (const float scale : {1.0f, 1000.0f})
    for (const bool up : {true, false}) {
      const auto step = series(1, 9, [&](auto, auto f) { return scale * ((f < 4) == up ? 2.0f : 3.0f); });
      EXPECT_EQ(keys_by(api::Table1Metric::relative, step, 1, 0.33), (Keys{0, 4, 8})) << scale << up;
      EXPECT_EQ(keys_by(api::Table1Metric::relative, step, 1, 0.34), (Keys{0, 8})) << scale << up;
    }
}

// Patch 0 shines with 4, patch 1 with 0 and then .3: the mean is about 2, half of it 1.04.
TEST(Table1, RelativeOfADarkPatchIsMeasuredAgainstHalfTheMean) {
  const auto dark = series(2, 9, [](auto p, auto f) { return p == 0 ? 4.0f : f < 4 ? 0.0f : 0.3f; });
  const double mean = (4 + 0.3 * 5 / 9) / 2;
  EXPECT_EQ(keys_by(api::Table1Metric::relative, dark, 1, 0.3 / (mean / 2) - 0.001), (Keys{0, 4, 8}));
  EXPECT_EQ(keys_by(api::Table1Metric::relative, dark, 1, 0.3 / (mean / 2) + 0.001), (Keys{0, 8}));
}

TEST(Table1, ADarkSequenceNeedsFirstAndLastWhateverTheMetric) {
  const auto dark = series(2, 9, [](auto, auto) { return 0.0f; });
  for (const auto metric :
       {api::Table1Metric::power, api::Table1Metric::radiosity, api::Table1Metric::relative})
    EXPECT_EQ(keys_by(metric, dark, 1, 1e-3), (Keys{0, 8}));
}

TEST(Table1, OneFrameIsOneKeyAndTwoAreTwo) {
  for (const LastKey last : {LastKey::marked, LastKey::lost}) {
    EXPECT_EQ(keys_of(series(1, 1, [](auto, auto) { return 1.0f; }), 0.1, last), (Keys{0}));
    EXPECT_EQ(keys_of(series(1, 2, [](auto, auto) { return 1.0f; }), 0.1, last), (Keys{0, 1}));
  }
}

}  // namespace
}  // namespace engine
