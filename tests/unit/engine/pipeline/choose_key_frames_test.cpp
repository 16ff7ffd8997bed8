// The choice of key-frames as stages of a job: cut off anywhere, it goes on to the same choice.
#include "engine/pipeline/choose_key_frames.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <utility>

#include "tests/support/temporary_folder.h"
#include "tests/unit/engine/pipeline/solve_room.h"

namespace engine {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// So few lines that noise leaves the keys open, and they are doubled.
api::LightingOptions noisy_options() {
  api::LightingOptions options = tests::quick_options();
  options.estimate_patch_edge_m = 1;
  options.estimate_line_count = 1'000;
  return options;
}

struct Attempt {
  api::Result<KeyFrames> chosen;
  api::JobReport report;
  std::vector<api::ProgressLine> lines;
};

enum class Until { done, first_save };

/// Until the first save of the estimate's, or to the end.
Attempt attempt(const tests::World& world, const api::LightingOptions& options, const fs::path& folder,
                Until until) {
  const auto times = [&] {
    std::error_code is_not_there;
    return std::pair(fs::last_write_time(folder / "estimate-direct", is_not_there),
                     fs::last_write_time(folder / "estimate-lines", is_not_there));
  };
  const auto before = times();
  std::atomic<bool> stopped = false;
  std::mutex mutex;
  Attempt result{api::Error{api::Fault::internal, "not tried"}, {}, {}};
  RunHooks hooks;
  hooks.stop_requested = [&] {
    return stopped || (stopped = until == Until::first_save && times() != before);
  };
  hooks.progress = [&](const api::ProgressLine& line) {
    const std::lock_guard lock(mutex);
    result.lines.push_back(line);
  };
  Checkpoints checkpoints(folder, "this job", 0ms);
  StageClock clock(hooks, result.report);
  const auto groups = light_groups(world.scene, world.animation, {}, kScaledGroupsMax);
  result.chosen = choose_key_frames(world.lit(), groups, options, checkpoints, clock, result.report);
  return result;
}

void expect_same(const Attempt& a, const Attempt& b) {
  EXPECT_EQ(a.chosen->keys, b.chosen->keys);
  EXPECT_EQ(a.chosen->checks, b.chosen->checks);
  EXPECT_EQ(a.chosen->solved, b.chosen->solved);
  EXPECT_EQ(a.chosen->predicted_error, b.chosen->predicted_error);
  EXPECT_EQ(a.report.counts, b.report.counts);
}

/// Where in stage `keyframes` it says for the first time that it goes on, or -1.
double went_on_from(const Attempt& attempt) {
  for (const api::ProgressLine& line : attempt.lines)
    if (line.stage == api::Stage::keyframes && line.message.starts_with("resumed"))
      return line.stage_fraction;
  return -1;
}

void expect_never_falls(const Attempt& attempt) {
  for (std::size_t k = 1; k < attempt.lines.size(); ++k) {
    const auto &before = attempt.lines[k - 1], &now = attempt.lines[k];
    ASSERT_GE(now.fraction, before.fraction);
    if (now.stage == before.stage) {
      ASSERT_GE(now.stage_fraction, before.stage_fraction);
    }
  }
}

double lines_of(const Attempt& attempt) {
  for (const auto& [name, value] : attempt.report.counts)
    if (name == "estimate_lines") return value;
  return 0;
}

// Every attempt gets one replicate further, and is told to stop as soon as that is saved.
TEST(ChooseKeyFrames, CutOffAfterEveryReplicateOfEveryRoundItChoosesTheSame) {
  const tests::LitRoom room(40);
  const api::LightingOptions options = noisy_options();
  const tests::TemporaryFolder undisturbed, cut;
  const Attempt whole = attempt(room, options, undisturbed.path() / "checkpoint", Until::done);
  ASSERT_TRUE(whole.chosen);
  ASSERT_GT(lines_of(whole), 1'000) << "there is one round only";

  // One save of direct light and one of every replicate; stopped after the last there is still the search.
  const int rounds = 1 + std::bit_width(static_cast<unsigned>(lines_of(whole) / 1'000) - 1);
  const int attempts = 1 + rounds * static_cast<int>(kEstimateReplicates) + 1;
  const fs::path folder = cut.path() / "checkpoint";
  double last = -1;
  for (int tries = 1;; ++tries) {
    ASSERT_LE(tries, attempts) << "one got no further";
    const Attempt next = attempt(room, options, folder, Until::first_save);
    expect_never_falls(next);
    if (tries > 2) {  // the first saves direct light, the second the first lines
      EXPECT_GT(went_on_from(next), last) << "no further than the attempt before";
      last = went_on_from(next);
    }
    if (!next.chosen) {
      ASSERT_EQ(next.chosen.error().fault, api::Fault::stopped);
      continue;
    }
    expect_same(next, whole);
    EXPECT_EQ(tries, attempts);
    break;
  }
}

TEST(ChooseKeyFrames, WhatIsChosenReplacesWhatItWasChosenBy) {
  const tests::LitRoom room(6);
  for (const auto mode : {api::LightingMode::standard, api::LightingMode::paper}) {
    api::LightingOptions options = noisy_options();
    options.mode = mode;
    const tests::TemporaryFolder temporary;
    const fs::path folder = temporary.path() / "checkpoint";
    ASSERT_FALSE(attempt(room, options, folder, Until::first_save).chosen);
    EXPECT_TRUE(fs::exists(folder / "estimate-direct"));
    ASSERT_FALSE(attempt(room, options, folder, Until::first_save).chosen);
    EXPECT_TRUE(fs::exists(folder / "estimate-lines"));
    const Attempt second = attempt(room, options, folder, Until::done);
    ASSERT_TRUE(second.chosen);
    EXPECT_TRUE(fs::exists(folder / "key-frames"));
    EXPECT_FALSE(fs::exists(folder / "estimate-lines"));
    EXPECT_FALSE(fs::exists(folder / "estimate-direct"));
    const Attempt third = attempt(room, options, folder, Until::done);
    ASSERT_TRUE(third.chosen);
    expect_same(third, second);
    EXPECT_TRUE(third.lines.empty()) << "nothing was left to do";
  }
}

TEST(ChooseKeyFrames, NoEstimateIsMadeWhereEveryFrameIsSolved) {
  const tests::BlinkingRoom room(4);
  const tests::TemporaryFolder temporary;
  const Attempt all = attempt(room, tests::quick_options(api::LightingMode::reference),
                              temporary.path() / "checkpoint", Until::done);
  ASSERT_TRUE(all.chosen);
  EXPECT_EQ(all.chosen->solved.size(), 4u);
  EXPECT_TRUE(all.report.counts.empty());
  EXPECT_FALSE(fs::exists(temporary.path() / "checkpoint"));
}

}  // namespace
}  // namespace engine
