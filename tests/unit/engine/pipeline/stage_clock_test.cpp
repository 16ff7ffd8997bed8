#include "engine/pipeline/stage_clock.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "engine/base/parallel.h"

namespace engine {
namespace {

using api::Stage;

constexpr std::array kAll{Stage::scene, Stage::patches,     Stage::estimate, Stage::keyframes, Stage::direct,
                          Stage::solve, Stage::interpolate, Stage::images,   Stage::publish};

/// What a run is told about.
struct Listener {
  std::vector<api::ProgressLine> lines;
  api::JobReport report;
  RunHooks hooks;
  std::optional<StageClock> clock;

  Listener() {
    hooks.progress = [this](const api::ProgressLine& line) { lines.push_back(line); };
    clock.emplace(hooks, report);
  }
  void expect_never_fell() const {
    for (std::size_t k = 1; k < lines.size(); ++k) {
      ASSERT_GE(lines[k].fraction, lines[k - 1].fraction) << k;
      if (lines[k].stage != lines[k - 1].stage) continue;
      ASSERT_GE(lines[k].stage_fraction, lines[k - 1].stage_fraction) << k;
    }
  }
};

TEST(StageClock, AllStagesTogetherAreTheWholeJob) {
  Listener run;
  for (const Stage stage : kAll) {
    const Progress& progress = run.clock->begin(stage);
    for (const double fraction : {0.0, 0.25, 0.5, 1.0}) progress.report(fraction);
  }
  run.expect_never_fell();
  EXPECT_EQ(run.lines.front().fraction, 0);
  EXPECT_EQ(run.lines.back().fraction, 1);
}

TEST(StageClock, FractionsNeverFallNorLeaveTheirRange) {
  Listener run;
  const Progress& progress = run.clock->begin(Stage::solve);
  for (const double fraction : {0.5, 0.2, -1.0, 0.7, 0.1, 2.0, 0.3}) progress.report(fraction);
  run.expect_never_fell();
  EXPECT_EQ(run.lines.back().stage_fraction, 1);
  EXPECT_LE(run.lines.back().fraction, 1);
}

TEST(StageClock, BeginningAStageTellsItAndStartsAtZero) {
  Listener run;
  run.clock->begin(Stage::scene).report(1.0);
  run.clock->begin(Stage::direct);
  EXPECT_EQ(run.lines.back().stage, Stage::direct);
  EXPECT_EQ(run.lines.back().stage_fraction, 0);
  EXPECT_GT(run.lines.back().fraction, run.lines.front().fraction);
}

TEST(StageClock, StagesThatAreLeftOutCountAsDone) {
  Listener with, without;
  for (const Stage stage : kAll) with.clock->begin(stage).report(1.0);
  without.clock->begin(Stage::scene);
  without.clock->begin(Stage::publish).report(1.0);
  EXPECT_EQ(with.lines.back().fraction, without.lines.back().fraction);
}

/// Solving and nothing else to speak of. So long that a test that is held up for a second sees no difference.
constexpr StageSeconds kThousandSeconds{0, 0, 0, 0, 0, 1000, 0, 0, 1e-3};

TEST(StageClock, WithoutAForecastNoTimeLeftIsTold) {
  Listener run;
  run.clock->begin(Stage::scene).report(0.5);
  EXPECT_FALSE(run.lines.back().seconds_left);
}

TEST(StageClock, AtFirstTheForecastIsBelieved) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect(kThousandSeconds);
  run.clock->begin(Stage::solve);
  ASSERT_TRUE(run.lines.back().seconds_left);
  EXPECT_NEAR(*run.lines.back().seconds_left, 1000, 50);
}

TEST(StageClock, SharesOfTheJobAreThoseOfTheExpectedWork) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect({0, 0, 3, 0, 0, 6, 0, 0, 1});
  run.clock->begin(Stage::estimate).report(1);
  const double before = run.lines.front().fraction;
  EXPECT_NEAR(run.lines.back().fraction, before + 0.3 * (1 - before), 0.01);
  run.clock->begin(Stage::solve).report(0.5);
  EXPECT_NEAR(run.lines.back().fraction, before + 0.6 * (1 - before), 0.01);
  run.clock->begin(Stage::publish).report(1);
  EXPECT_EQ(run.lines.back().fraction, 1);
  EXPECT_EQ(run.lines.back().seconds_left, 0);
  run.expect_never_fell();
}

// Half of what was expected to take 1000 s is done in 0.1 s.
TEST(StageClock, TheTimeLeftFollowsTheMeasuredPace) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect(kThousandSeconds);
  const Progress& progress = run.clock->begin(Stage::solve);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  progress.report(0.5);
  ASSERT_TRUE(run.lines.back().seconds_left);
  // 0.5 (0.1 + 0.1 * 1000 q) / (0.5 + 0.1) s, where q = 0.986: what took so short tells little.
  EXPECT_NEAR(*run.lines.back().seconds_left, 82, 5);
}

// The first stage takes no time, of 100 s expected; the second was expected to take as long.
TEST(StageClock, AStageThatWasOverAtOnceSaysLittleOfTheOthers) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect({0, 0, 100, 0, 0, 100, 0, 0, 1e-3});
  run.clock->begin(Stage::estimate).report(1);
  run.clock->begin(Stage::solve);
  ASSERT_TRUE(run.lines.back().seconds_left);
  EXPECT_GT(*run.lines.back().seconds_left, 60);
}

// A stage of 0.1 s expected takes 1 s, and so does a tenth of the next, which was expected to take 1 s in
// all.
TEST(StageClock, WhereEverythingTakesLongerAllThatIsLeftDoesToo) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect({0, 0, 0.1, 0, 0, 0.1, 0, 0.1, 1e-3});
  const Progress& estimating = run.clock->begin(Stage::estimate);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  estimating.report(1);
  const Progress& solving = run.clock->begin(Stage::solve);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  solving.report(0.5);
  ASSERT_TRUE(run.lines.back().seconds_left);
  EXPECT_GT(*run.lines.back().seconds_left, 0.5) << "as long again, and the images";
}

TEST(StageClock, AStageThatWasNotExpectedIsTimedByItsOwnPace) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect({0, 0, 0, 0, 0, 0, 0, 0, 1e-3});
  const Progress& progress = run.clock->begin(Stage::direct);
  EXPECT_LT(*run.lines.back().seconds_left, 0.1);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  progress.report(0.5);
  EXPECT_GT(*run.lines.back().seconds_left, 0.3);
}

TEST(StageClock, WhatAnEarlierAttemptDidIsProgressAndNoMeasureOfPace) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect(kThousandSeconds);
  run.clock->begin(Stage::solve);
  run.clock->go_on_from(0.8, "goes on");
  EXPECT_EQ(run.lines.back().stage_fraction, 0.8);
  EXPECT_EQ(run.lines.back().message, "goes on, from 80 % of this stage on");
  EXPECT_GT(run.lines.back().fraction, 0.75);
  ASSERT_TRUE(run.lines.back().seconds_left);
  EXPECT_NEAR(*run.lines.back().seconds_left, 200, 10) << "a fifth, at the pace expected";
}

TEST(StageClock, MoreFramesThanExpectedMakeTheTimeLeftLongerAndTheFractionDoesNotFall) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->expect({0, 0, 5, 0, 0, 10, 0, 0, 1e-3});
  run.clock->ask([](std::uint32_t frames) { return StageSeconds{0, 0, 5, 0, 0, 1.0 * frames, 0, 0, 1e-3}; });
  run.clock->begin(Stage::estimate).report(1);
  const double before = run.lines.back().fraction;
  run.clock->frames_to_solve(40);
  const Progress& progress = run.clock->begin(Stage::solve);
  EXPECT_NEAR(run.lines.back().fraction, before, 0.01);
  progress.report(0.5);
  EXPECT_NEAR(run.lines.back().fraction, (1 + before) / 2, 0.01);
  run.clock->begin(Stage::publish).report(1);
  EXPECT_EQ(run.lines.back().fraction, 1);
  run.expect_never_fell();
}

TEST(StageClock, SecondsOfEachStageAreReportedInOrder) {
  Listener run;
  run.clock->begin(Stage::scene);
  run.clock->begin(Stage::solve);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  ASSERT_EQ(run.report.stage_seconds.size(), 1u);
  run.clock.reset();  // the end of a run ends its last stage
  ASSERT_EQ(run.report.stage_seconds.size(), 2u);
  EXPECT_EQ(run.report.stage_seconds[0].first, Stage::scene);
  EXPECT_EQ(run.report.stage_seconds[1].first, Stage::solve);
  EXPECT_GE(run.report.stage_seconds[0].second, 0);
  EXPECT_LT(run.report.stage_seconds[0].second, run.report.stage_seconds[1].second);
  EXPECT_GE(run.report.stage_seconds[1].second, 0.03);
}

TEST(StageClock, WithoutAStageNothingIsReported) {
  Listener run;
  run.clock.reset();
  EXPECT_TRUE(run.report.stage_seconds.empty());
  EXPECT_TRUE(run.lines.empty());
}

TEST(StageClock, StopIsThatOfTheRun) {
  Listener run;
  bool stop = false;
  run.hooks.stop_requested = [&] { return stop; };
  const Progress& progress = run.clock->begin(Stage::solve);
  EXPECT_FALSE(progress.stop_requested());
  stop = true;
  EXPECT_TRUE(progress.stop_requested());
}

// The listener is no container for threads: that it is called one at a time is what is tested.
TEST(StageClock, ReportsFromManyThreadsComeOneByOneAndInOrder) {
  Listener run;
  const Progress& progress = run.clock->begin(Stage::solve);
  parallel_for(20'000, [&](std::size_t k) { progress.report(static_cast<double>(k % 1'000) / 1'000); });
  EXPECT_EQ(run.lines.size(), 20'001u);
  run.expect_never_fell();
}

}  // namespace
}  // namespace engine
