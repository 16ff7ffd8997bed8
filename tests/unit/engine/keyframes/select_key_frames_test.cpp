#include "engine/keyframes/select_key_frames.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using api::FrameKind;
using api::LightingMode;
using Keys = std::vector<FrameIndex>;
using tests::series;
using tests::Squares;

api::LightingOptions options_of(LightingMode mode) {
  api::LightingOptions options;
  options.mode = mode;
  options.tolerance = 0.01;
  options.epsilon = 0.5;
  return options;
}

Estimate estimate_of(const tests::World& world, const PatchSeries& radiosity, const PatchSeries& indirect) {
  return {world.patches, radiosity, indirect, std::vector<float>(world.patches.count(), 0.0f)};
}

KeyFrames select(const tests::World& world, const PatchSeries& radiosity, const PatchSeries& indirect,
                 LightingMode mode = LightingMode::standard) {
  return *select_key_frames(world.scene, world.animation, world.static_rays,
                            estimate_of(world, radiosity, indirect), options_of(mode), Progress{});
}

Keys of_kind(const KeyFrames& chosen, FrameKind kind) {
  Keys frames;
  for (const api::FrameRecord& record : chosen.report.frames)
    if (record.kind == kind) frames.push_back(record.frame);
  return frames;
}

const auto kConstant = [](auto, auto) { return 1.0f; };

TEST(AllFrames, AreKeysAndNothingIsInterpolated) {
  const KeyFrames chosen = all_frames(options_of(LightingMode::reference), 4);
  EXPECT_EQ(chosen.keys, (Keys{0, 1, 2, 3}));
  EXPECT_EQ(chosen.solved, chosen.keys);
  EXPECT_TRUE(chosen.checks.empty());
  EXPECT_EQ(of_kind(chosen, FrameKind::key), chosen.keys);
  EXPECT_EQ(chosen.report.intervals.size(), 3u);
  EXPECT_EQ(chosen.report.mode, LightingMode::reference);
  for (const api::FrameRecord& record : chosen.report.frames) EXPECT_EQ(record.error, 0.0);
}

TEST(SelectKeyFrames, AStaticSequenceHasFirstAndLastAndACheckBetween) {
  const Squares world(2, 21);
  const auto constant = series(2, 21, kConstant);
  const KeyFrames chosen = select(world, constant, constant);
  EXPECT_EQ(chosen.keys, (Keys{0, 20}));
  EXPECT_EQ(chosen.checks, (Keys{10}));
  EXPECT_EQ(chosen.solved, (Keys{0, 10, 20}));
  EXPECT_EQ(of_kind(chosen, FrameKind::key), chosen.keys);
  EXPECT_EQ(of_kind(chosen, FrameKind::check), chosen.checks);
  EXPECT_EQ(chosen.report.frames.size(), 21u);
  ASSERT_EQ(chosen.report.intervals.size(), 1u);
  EXPECT_EQ(chosen.report.intervals[0].predicted_error, 0.0);
  EXPECT_FALSE(chosen.report.intervals[0].observed_error);
}

TEST(SelectKeyFrames, OneFrameIsOneKeyInEveryMode) {
  const Squares world(1, 1);
  const auto one = series(1, 1, kConstant);
  for (const LightingMode mode : {LightingMode::standard, LightingMode::paper, LightingMode::paper_literal}) {
    const KeyFrames chosen = select(world, one, one, mode);
    EXPECT_EQ(chosen.solved, (Keys{0}));
    EXPECT_TRUE(chosen.report.intervals.empty());
  }
}

TEST(SelectKeyFrames, AnObjectThatComesAndGoesForcesThePairsAroundIt) {
  Scene scene = tests::squares(2);
  Animation animation = tests::still(scene, 30);
  animation.objects[1].spans = {{5, 6, {}}, {7, 11, tests::moved_to(1, 0, 0)}, {20, 29, {}}};
  const tests::World world(scene, animation, 1.0);
  const auto constant = series(2, 30, kConstant);
  const KeyFrames chosen = select(world, constant, constant);
  EXPECT_EQ(chosen.keys, (Keys{0, 4, 5, 11, 12, 19, 20, 29}));  // at 7 it only moves
  EXPECT_EQ(chosen.checks, (Keys{2, 8, 15, 24}));
}

/// Keys where the light's exitance follows `knots` and the estimate sees no difference.
Keys keys_of_lamp(const std::vector<std::pair<std::uint32_t, float>>& knots) {
  Scene scene = tests::squares(1);
  Animation animation = tests::still(scene, 30);
  animation.emission.exitance_w_m2[0].clear();
  for (FrameIndex f = 0; f < 30; ++f)
    animation.emission.exitance_w_m2[0].push_back(Rgb{0.2f, 1, 0} * tests::through_knots(knots, f));
  const tests::World world(scene, animation, 1.0);
  const auto constant = series(1, 30, kConstant);
  return select(world, constant, constant).keys;
}

TEST(SelectKeyFrames, ALightThatIsSwitchedForcesThePairsAroundIt) {
  EXPECT_EQ(keys_of_lamp({{0, 0}, {9, 0}, {10, 50}, {20, 50}, {21, 0}, {29, 0}}),
            (Keys{0, 9, 10, 20, 21, 29}));
  EXPECT_EQ(keys_of_lamp({{0, 50}, {9, 50}, {10, 20}, {29, 20}}), (Keys{0, 9, 10, 29}));
}

TEST(SelectKeyFrames, ALightThatIsDimmedOrCreepsForcesNone) {
  EXPECT_EQ(keys_of_lamp({{0, 0}, {29, 50}}), (Keys{0, 29}));
  EXPECT_EQ(keys_of_lamp({{0, 0}, {9, 0}, {11, 50}, {29, 50}}), (Keys{0, 29}));    // a ramp of two frames
  EXPECT_EQ(keys_of_lamp({{0, 50}, {9, 50}, {10, 49}, {29, 49}}), (Keys{0, 29}));  // a small step
}

TEST(SelectKeyFrames, TheDefaultLooksAtTheIndirectPartAndThePaperAtAll) {
  const Squares world(1, 11);
  const auto total = series(1, 11, [](auto, auto f) { return f == 5 ? 3.0f : 1.0f; });
  const auto indirect = series(1, 11, [](auto, auto) { return 0.2f; });
  EXPECT_EQ(select(world, total, indirect).keys, (Keys{0, 10}));
  const KeyFrames paper = select(world, total, indirect, LightingMode::paper);
  EXPECT_EQ(paper.keys, (Keys{0, 5, 6, 10}));
  EXPECT_EQ(paper.solved, paper.keys);
  EXPECT_TRUE(paper.checks.empty());
  EXPECT_FALSE(paper.report.intervals[0].predicted_error);  // Table 1 predicts none
  EXPECT_FALSE(paper.report.frames[2].error);
  EXPECT_EQ(select(world, total, indirect, LightingMode::paper_literal).keys, (Keys{0, 5, 10}));
}

TEST(SelectKeyFrames, PredictedErrorsAreThoseOfTheFramesThatAreInterpolated) {
  const Squares world(1, 9);
  const auto bent = series(1, 9, [](auto, auto f) { return f == 2 ? 1.004f : 1.0f; });  // 0.4 %, allowed 1 %
  const KeyFrames chosen = select(world, bent, bent);
  ASSERT_EQ(chosen.solved, (Keys{0, 4, 8}));
  EXPECT_NEAR(*chosen.report.frames[2].error, 0.004, 1e-4);
  EXPECT_EQ(chosen.report.frames[4].error, 0.0);
  EXPECT_NEAR(*chosen.report.intervals[0].predicted_error, 0.004, 1e-4);
}

// Keys 0, 8, 12, checks 4, 10: of the solved frames, at positions 0 .. 4.
TEST(ObserveErrors, IsTheErrorOfHavingLeftOutTheCheckOfEachInterval) {
  const Squares world(1, 13);
  KeyFrames chosen;
  chosen.keys = {0, 8, 12, 13};
  chosen.checks = {2, 10};
  chosen.solved = {0, 2, 8, 10, 12, 13};
  chosen.report.intervals = {{0, 8, {}, {}}, {8, 12, {}, {}}, {12, 13, {}, {}}};
  const auto solved =
      series(1, 6, [](auto, auto k) { return std::array{1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 5.0f}[k]; });
  observe_errors(world.lit(), solved, solved, chosen);
  // Frame 2 is a quarter of the way from 1 to 3: 1.5 against 2. Frame 10 is the middle of 3 and 5.
  EXPECT_NEAR(chosen.report.intervals[0].observed_error.value(), 0.25, 1e-6);
  EXPECT_NEAR(chosen.report.intervals[1].observed_error.value(), 0, 1e-6);
  EXPECT_FALSE(chosen.report.intervals[2].observed_error);  // nothing between its keys
}

}  // namespace
}  // namespace engine
