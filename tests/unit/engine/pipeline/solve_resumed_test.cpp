// A sequence whose solution is cut off, and goes on from its checkpoints to the same bytes.
#include <gtest/gtest.h>

#include <atomic>

#include "engine/animation/light_groups.h"
#include "engine/keyframes/select_key_frames.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/engine/pipeline/solve_room.h"

namespace engine {
namespace {

using namespace std::chrono_literals;
using tests::quick_options;
using tests::Solution;

/// Checkpoints that are always due.
Checkpoints checkpoints_in(const tests::TemporaryFolder& folder) {
  return {folder.path() / "checkpoint", "this job", 0ms};
}

struct Attempt {
  api::Result<Solution> solution;
  long asked = 0;        ///< how often it asked whether to stop
  long asked_early = 0;  ///< of these, before direct light or the solution: nothing is kept of that
  double began_at = -1;  ///< share of the solution that was done when it began
};

/// One attempt that is told to stop when it asks for the `stop_at`th time; 0: never.
Attempt attempt(const LitScene& lit, const api::LightingOptions& options,
                const tests::TemporaryFolder& folder, long stop_at) {
  std::atomic<long> asked = 0, asked_early = -1;
  double began_at = -1, last = 0;
  RunHooks hooks;
  hooks.stop_requested = [&] { return ++asked >= stop_at && stop_at > 0; };
  hooks.progress = [&](const api::ProgressLine& line) {
    const bool after_estimate = line.stage == api::Stage::direct || line.stage == api::Stage::solve;
    if (after_estimate && asked_early < 0) asked_early = asked.load();
    if (line.stage != api::Stage::solve) return;
    // The stage begins at 0, and goes on from where it was in the next line.
    if (began_at < 0 && line.stage_fraction > 0) began_at = line.stage_fraction;
    EXPECT_GE(line.stage_fraction, last);
    last = line.stage_fraction;
  };
  Checkpoints checkpoints = checkpoints_in(folder);
  auto solution = tests::try_to_solve(lit, options, checkpoints, hooks);
  return {std::move(solution), asked, asked_early, began_at};
}

void expect_same(const Solution& a, const Solution& b) {
  EXPECT_EQ(a.sequence.radiosity_w_m2.values, b.sequence.radiosity_w_m2.values);
  ASSERT_EQ(a.sequence.others.size(), b.sequence.others.size());
  for (std::size_t k = 0; k < a.sequence.others.size(); ++k) {
    EXPECT_EQ(a.sequence.others[k].file, b.sequence.others[k].file);
    EXPECT_EQ(a.sequence.others[k].values_w_m2.values, b.sequence.others[k].values_w_m2.values);
  }
  EXPECT_EQ(api::key_frame_report_json(a.sequence.key_frames),
            api::key_frame_report_json(b.sequence.key_frames));
  EXPECT_EQ(a.report.noise, b.report.noise);
  EXPECT_EQ(a.report.counts, b.report.counts);
  EXPECT_EQ(a.report.warnings, b.report.warnings);
}

/// Stops attempts at `places` between the beginning of the direct light and the end; after each a second
/// attempt finds what the first left behind. Answers the undisturbed solution.
Solution expect_same_when_resumed(const LitScene& lit, const api::LightingOptions& options, int places = 5) {
  const tests::TemporaryFolder undisturbed;
  Attempt whole = attempt(lit, options, undisturbed, 0);
  EXPECT_TRUE(whole.solution);
  const long early = whole.asked_early;
  int resumed = 0;
  for (int k = 1; k <= places; ++k) {
    const tests::TemporaryFolder folder;
    Attempt first =
        attempt(lit, options, folder, early + std::max(1l, (whole.asked - early) * k / (places + 1)));
    EXPECT_TRUE(!first.solution && first.solution.error().fault == api::Fault::stopped) << k;
    const Attempt second = attempt(lit, options, folder, 0);
    EXPECT_TRUE(second.solution) << k;
    EXPECT_LT(second.asked, whole.asked + 1);
    resumed += second.asked < whole.asked ? 1 : 0;
    expect_same(*second.solution, *whole.solution);
    if (::testing::Test::HasFailure()) break;
  }
  EXPECT_GT(resumed, places * 2 / 3) << "hardly anything was kept";
  return std::move(*whole.solution);
}

TEST(SolveSequenceResumed, GivesTheSameBytesInModeDefault) {
  const tests::BlinkingRoom room(10);
  api::LightingOptions options = quick_options();
  options.light_groups = {{"lamps", {"lamp"}}};
  expect_same_when_resumed(room.lit(), options);
}

TEST(SolveSequenceResumed, GivesTheSameBytesWhereEveryFrameIsSolved) {
  const tests::BlinkingRoom room(6);
  expect_same_when_resumed(room.lit(), quick_options(api::LightingMode::reference));
}

TEST(SolveSequenceResumed, GivesTheSameBytesWhereATargetErrorAddsPassesAndLines) {
  const tests::BlinkingRoom room(4);
  api::LightingOptions options = quick_options();
  options.samples_per_light = 2;
  options.target_error = 0.15;
  expect_same_when_resumed(room.lit(), options);
}

TEST(SolveSequenceResumed, GivesTheSameBytesWhereEveryFrameIsSolvedAlone) {
  const tests::BlinkingRoom room(12);
  expect_same_when_resumed(room.lit(), quick_options(api::LightingMode::frame_by_frame));
}

// What is saved depends on how long saving takes; what is left to do is that much less.
TEST(SolveSequenceResumed, ProgressOfFramesSolvedAloneBeginsWithWhatIsDone) {
  const tests::BlinkingRoom room(12);
  const auto options = quick_options(api::LightingMode::frame_by_frame);
  const tests::TemporaryFolder undisturbed, folder;
  const Attempt whole = attempt(room.lit(), options, undisturbed, 0);
  EXPECT_LT(whole.began_at, 1.0 / 12);
  EXPECT_FALSE(attempt(room.lit(), options, folder, whole.asked / 2).solution);
  const Attempt second = attempt(room.lit(), options, folder, 0);
  ASSERT_TRUE(second.solution);
  EXPECT_GT(second.began_at, 0.9 / 12);
  EXPECT_NEAR(static_cast<double>(second.asked) / static_cast<double>(whole.asked), 1 - second.began_at,
              0.05);
}

TEST(SolveSequenceResumed, GivesTheSameBytesInThePapersMode) {
  const tests::BlinkingRoom room(6);
  expect_same_when_resumed(room.lit(), quick_options(api::LightingMode::paper));
}

// The estimate's patches of 3 m do not see what the solution's of half a metre do.
TEST(SolveSequenceResumed, GivesTheSameBytesWhereIntervalsAreSplit) {
  const tests::PassingRoom room;
  api::LightingOptions options = quick_options();
  options.estimate_patch_edge_m = 3;
  options.estimate_line_count = 20'000;
  options.line_count = options.moving_line_count = 100'000;
  options.samples_per_light = 64;
  options.tolerance = 0.02;
  const Solution solution = expect_same_when_resumed(room.lit(), options, 3);

  const auto groups = light_groups(room.scene, room.animation, {}, kScaledGroupsMax);
  auto estimator =
      Estimator::begin(room.scene, room.animation, room.static_rays, groups, options, Progress{});
  ASSERT_TRUE(estimator);
  const auto chosen = select_key_frames(*estimator, options, Progress{});
  ASSERT_TRUE(chosen);
  EXPECT_GT(solution.count("key_frames"), static_cast<double>(chosen->keys.size())) << "nothing was split";
  for (const api::KeyFrameInterval& interval : solution.sequence.key_frames.intervals) {
    EXPECT_EQ(interval.kept, true);
    EXPECT_LE(interval.observed_error.value_or(0), options.tolerance);
  }
}

}  // namespace
}  // namespace engine
