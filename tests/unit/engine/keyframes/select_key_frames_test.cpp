#include "engine/keyframes/select_key_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "engine/animation/light_groups.h"
#include "engine/keyframes/fewest_key_frames.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using api::FrameKind;
using api::LightingMode;
using Keys = std::vector<FrameIndex>;
using tests::LitRoom;

api::LightingOptions options_of(LightingMode mode) {
  api::LightingOptions options;
  options.mode = mode;
  options.interpolated =
      mode == LightingMode::standard ? api::Interpolated::indirect : api::Interpolated::total;
  options.estimate_patch_edge_m = 1;
  options.estimate_line_count = 20'000;
  return options;
}

struct Selected {
  KeyFrames chosen;
  std::uint64_t lines = 0;
  api::KeyFrameReport report;
};

Selected select(const tests::World& world, const api::LightingOptions& options) {
  const auto groups = light_groups(world.scene, world.animation, {}, kScaledGroupsMax);
  auto estimator =
      Estimator::begin(world.scene, world.animation, world.static_rays, groups, options, Progress{});
  EXPECT_TRUE(estimator);
  auto chosen = select_key_frames(*estimator, options, Progress{});
  EXPECT_TRUE(chosen);
  const api::KeyFrameReport report = report_of(*chosen, options, world.animation.frame_count);
  return {std::move(*chosen), estimator->estimate().line_count, report};
}

/// The lit room in which everything rests.
std::unique_ptr<tests::World> room_at_rest(FrameIndex frames) {
  const Scene scene = tests::lit_room_scene(false);
  Animation animation = tests::lit_room_animation(scene, frames);
  for (ObjectMotion& motion : animation.objects) motion.spans = {{0, frames - 1, {}}};
  return std::make_unique<tests::World>(scene, animation, 1.0);
}

bool contains(const Keys& keys, FrameIndex frame) {
  return std::binary_search(keys.begin(), keys.end(), frame);
}

TEST(AllFrames, AreKeysAndNothingIsInterpolated) {
  const KeyFrames chosen = all_frames(4);
  EXPECT_EQ(chosen.keys, (Keys{0, 1, 2, 3}));
  EXPECT_EQ(chosen.solved, chosen.keys);
  EXPECT_TRUE(chosen.checks.empty());
  const auto report = report_of(chosen, options_of(LightingMode::reference), 4);
  EXPECT_EQ(report.mode, LightingMode::reference);
  EXPECT_EQ(report.intervals.size(), 3u);
  EXPECT_FALSE(report.tolerance);
  for (const api::FrameRecord& record : report.frames) {
    EXPECT_EQ(record.kind, FrameKind::key);
    EXPECT_EQ(record.error, 0.0);
  }
}

TEST(ChecksOf, AreTheMiddleOrOfLongIntervalsAThirdAndTwoThirds) {
  EXPECT_EQ(checks_between(3, 4), Keys{});
  EXPECT_EQ(checks_between(3, 5), (Keys{4}));
  EXPECT_EQ(checks_between(3, 8), (Keys{5}));
  EXPECT_EQ(checks_between(3, 9), (Keys{5, 7}));
  EXPECT_EQ(checks_between(0, 100), (Keys{33, 67}));
  EXPECT_EQ(checks_of({0, 1, 3, 6, 12}), (Keys{2, 4, 8, 10}));
  EXPECT_EQ(checks_of({5}), Keys{});
}

TEST(SelectKeyFrames, AStaticSequenceHasFirstAndLastAndChecksBetween) {
  const auto room = room_at_rest(21);
  const Selected selected = select(*room, options_of(LightingMode::standard));
  EXPECT_EQ(selected.chosen.keys, (Keys{0, 20}));
  EXPECT_EQ(selected.chosen.checks, (Keys{6, 14}));
  EXPECT_EQ(selected.chosen.solved, (Keys{0, 6, 14, 20}));
  EXPECT_EQ(selected.lines, 20'000u) << "without noise there is nothing to sharpen";
  ASSERT_EQ(selected.report.intervals.size(), 1u);
  EXPECT_LT(selected.report.intervals[0].predicted_error.value(), 1e-6);
  EXPECT_EQ(selected.report.intervals[0].kept, true);
  EXPECT_FALSE(selected.report.intervals[0].observed_error);
  EXPECT_EQ(selected.report.tolerance, 0.05);
}

TEST(SelectKeyFrames, OneFrameIsOneKeyInEveryMode) {
  const auto room = room_at_rest(1);
  for (const LightingMode mode : {LightingMode::standard, LightingMode::paper, LightingMode::paper_literal}) {
    const Selected selected = select(*room, options_of(mode));
    EXPECT_EQ(selected.chosen.solved, (Keys{0}));
    EXPECT_TRUE(selected.report.intervals.empty());
  }
}

TEST(SelectKeyFrames, WindowsOfManyFramesShareAKey) {
  const auto room = room_at_rest(2 * kIntervalMax + 2);
  EXPECT_EQ(select(*room, options_of(LightingMode::standard)).chosen.keys,
            (Keys{0, kIntervalMax, 2 * kIntervalMax, 2 * kIntervalMax + 1}));
}

// Object 2 is there in frames 2, 3 and 7.
TEST(SelectKeyFrames, AThingThatComesAndGoesForcesThePairsAroundIt) {
  LitRoom room(12);
  room.animation.objects[1].spans = {{0, 11, {}}};
  const tests::World world(room.scene, room.animation, 1.0);
  api::LightingOptions options = options_of(LightingMode::standard);
  options.tolerance = 1;
  const KeyFrames chosen = select(world, options).chosen;
  EXPECT_EQ(chosen.keys, (Keys{0, 1, 2, 3, 4, 6, 7, 8, 11}));
  EXPECT_EQ(chosen.checks, (Keys{5, 9}));
}

// A single lamp that blinks is a scale, which is computed in every frame; where lamps are not groups of
// their own (all light is interpolated) it jumps.
TEST(SelectKeyFrames, ALampThatBlinksAsAWholeCostsNoKey) {
  auto room = room_at_rest(20);
  auto& lamp = room->animation.emission.exitance_w_m2[1];
  lamp.clear();
  for (FrameIndex f = 0; f < 20; ++f) lamp.push_back(Rgb{10, 8, 5} * (f / 5 % 2 == 0 ? 1.0f : 0.0f));
  const tests::World world(room->scene, room->animation, 1.0);
  EXPECT_EQ(select(world, options_of(LightingMode::standard)).chosen.keys, (Keys{0, 19}));
}

TEST(SelectKeyFrames, NoFrameIsExpectedToMissByMoreThanIsAimedFor) {
  const LitRoom room(40);
  for (const auto interpolation : {api::Interpolation::linear, api::Interpolation::monotone_cubic}) {
    api::LightingOptions options = options_of(LightingMode::standard);
    options.interpolation = interpolation;
    options.tolerance = 0.03;
    const Selected selected = select(room, options);
    EXPECT_GT(selected.chosen.keys.size(), 9u);
    EXPECT_LT(selected.chosen.solved.size(), 40u);
    for (FrameIndex f = 0; f < 40; ++f) {
      EXPECT_LE(selected.chosen.predicted_error[f], kAim * options.tolerance);
      if (contains(selected.chosen.keys, f)) {
        EXPECT_EQ(selected.chosen.predicted_error[f], 0);
      }
    }
    for (const FrameIndex jump : {1, 2, 3, 4, 6, 7, 8}) EXPECT_TRUE(contains(selected.chosen.keys, jump));
    EXPECT_EQ(selected.chosen.checks, checks_of(selected.chosen.keys));
  }
}

TEST(SelectKeyFrames, ASmallerToleranceTakesMoreKeys) {
  const LitRoom room(40);
  api::LightingOptions options = options_of(LightingMode::standard);
  options.tolerance = 0.2;
  const std::size_t few = select(room, options).chosen.keys.size();
  options.tolerance = 0.03;
  EXPECT_GT(select(room, options).chosen.keys.size(), few);
}

TEST(SelectKeyFrames, LinesAreDoubledWhileNoiseLeavesTheKeysOpen) {
  const LitRoom room(40);
  api::LightingOptions options = options_of(LightingMode::standard);
  options.estimate_line_count = 1'000;
  const Selected noisy = select(room, options);
  EXPECT_GT(noisy.lines, 1'000u);
  EXPECT_LE(noisy.lines, 1'000u << kEstimateRounds);
  EXPECT_EQ(noisy.lines % 1'000, 0u);
}

TEST(SelectKeyFrames, ThePapersModesScanTotalRadiosityAndPredictNothing) {
  const LitRoom room(20);
  api::LightingOptions options = options_of(LightingMode::paper);
  options.metric = api::Table1Metric::relative;
  options.epsilon = 0.2;
  const Selected paper = select(room, options);
  EXPECT_EQ(paper.chosen.solved, paper.chosen.keys);
  EXPECT_TRUE(paper.chosen.checks.empty());
  EXPECT_EQ(paper.lines, 20'000u);
  EXPECT_FALSE(paper.report.tolerance);
  for (const api::KeyFrameInterval& interval : paper.report.intervals) {
    EXPECT_FALSE(interval.predicted_error);
    EXPECT_FALSE(interval.kept);
  }
  options.mode = LightingMode::paper_literal;
  const Selected literal = select(room, options);
  ASSERT_GT(paper.chosen.keys.size(), 3u);
  EXPECT_EQ(literal.chosen.keys.size() + 1, paper.chosen.keys.size()) << "the last one found is lost";
}

TEST(SelectKeyFrames, StopsWhenToldTo) {
  const LitRoom room(10);
  const auto groups = light_groups(room.scene, room.animation, {}, kScaledGroupsMax);
  const api::LightingOptions options = options_of(LightingMode::standard);
  auto estimator =
      Estimator::begin(room.scene, room.animation, room.static_rays, groups, options, Progress{});
  ASSERT_TRUE(estimator);
  Progress progress;
  progress.stop_requested = [] { return true; };
  const auto chosen = select_key_frames(*estimator, options, progress);
  ASSERT_FALSE(chosen);
  EXPECT_EQ(chosen.error().fault, api::Fault::stopped);
}

TEST(ReportOf, SaysWhatEachFrameIsAndWhatIsExpected) {
  KeyFrames chosen;
  chosen.keys = {0, 4, 5};
  chosen.checks = {2};
  merge_solved(chosen);
  chosen.predicted_error = {0, 0.01, 0.02, 0.07, 0, 0};
  const auto report = report_of(chosen, options_of(LightingMode::standard), 6);
  std::vector<FrameKind> kinds;
  for (const api::FrameRecord& record : report.frames) kinds.push_back(record.kind);
  using enum FrameKind;
  EXPECT_EQ(kinds, (std::vector<FrameKind>{key, interpolated, check, interpolated, key, key}));
  EXPECT_EQ(report.frames[1].error, 0.01);
  EXPECT_EQ(report.frames[2].error, 0.0) << "it is solved";
  ASSERT_EQ(report.intervals.size(), 2u);
  EXPECT_EQ(report.intervals[0].predicted_error, 0.07);
  EXPECT_EQ(report.intervals[0].kept, false);
  EXPECT_EQ(report.intervals[1].kept, true);
}

}  // namespace
}  // namespace engine
