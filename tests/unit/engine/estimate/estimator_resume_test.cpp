// The estimate of the lighting: the same bytes on any number of threads, and wherever it was cut off.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/parallel.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/engine/estimate/estimating.h"

namespace engine {
namespace {

using namespace std::chrono_literals;
using tests::begin_estimate;
using tests::blinking_room;
using tests::LitRoom;
using tests::options_with;

/// What an estimate comes to.
struct Outcome {
  RgbValues radiosity, interpolated;
  std::uint64_t line_count = 0;
  bool operator==(const Outcome&) const = default;
};

constexpr std::uint64_t kFirst = 800, kSecond = 2'400;

/// Two steps of lines, in windows and replicates. Nothing where it was stopped.
std::optional<Outcome> attempt(
    const tests::World& world, const api::LightingOptions& options, Checkpoints* files,
    const Progress& progress, const std::function<void(double)>& go_on_from = [](double) {}) {
  const auto groups = light_groups(world.scene, world.animation, {}, kScaledGroupsMax);
  auto estimator = Estimator::begin(world.scene, world.animation, world.static_rays, groups, options,
                                    progress, {files, go_on_from});
  if (!estimator) return std::nullopt;
  for (const std::uint64_t lines : {kFirst, kSecond})
    if (!estimator->is_beyond(lines) && !estimator->add_lines_up_to(lines, progress)) return std::nullopt;
  const Estimate& estimate = estimator->estimate();
  return Outcome{estimate.radiosity_w_m2.values, estimate.interpolated.values, estimate.line_count};
}

TEST(Estimator, IsTheSameForAnyNumberOfThreads) {
  const auto room = blinking_room(6);
  const auto options = options_with(api::DirectLight::apart, api::Interpolated::indirect);
  const auto all_cores = attempt(*room, options, nullptr, {});
  set_thread_count(1);
  const auto one = attempt(*room, options, nullptr, {});
  set_thread_count(7);
  const auto seven = attempt(*room, options, nullptr, {});
  set_thread_count(0);
  ASSERT_TRUE(all_cores);
  EXPECT_EQ(all_cores, one);
  EXPECT_EQ(all_cores, seven);
}

/// Asks to stop as soon as one of `names` is saved.
class StopAfterSave {
 public:
  StopAfterSave(const tests::TemporaryFolder& folder, const std::vector<std::string>& names) {
    for (const std::string& name : names) files_.emplace_back(folder.path() / "checkpoint" / name);
    before_ = times();
  }
  Progress progress() {
    return {[](double) {}, [this] { return stopped_ || (stopped_ = times() != before_); }};
  }

 private:
  using Times = std::vector<std::filesystem::file_time_type>;
  Times times() const {
    Times times;
    std::error_code is_not_there;
    for (const auto& file : files_) times.push_back(std::filesystem::last_write_time(file, is_not_there));
    return times;
  }

  std::vector<std::filesystem::path> files_;
  Times before_;
  std::atomic<bool> stopped_ = false;
};

/// One attempt after the other goes on from the save at which the one before was stopped, until one is done.
/// Answers the shares of the direct light that they were told was done.
std::vector<double> expect_same_after_every_save(const tests::World& world,
                                                 const api::LightingOptions& options,
                                                 const std::vector<std::string>& names,
                                                 std::size_t saves_expected) {
  const auto whole = attempt(world, options, nullptr, {});
  EXPECT_TRUE(whole);
  std::vector<double> shares;
  const tests::TemporaryFolder folder;
  for (std::size_t saves = 1; saves <= saves_expected + 1; ++saves) {
    StopAfterSave stop(folder, names);
    Checkpoints files(folder.path() / "checkpoint", "this job", 0ms);
    const auto outcome =
        attempt(world, options, &files, stop.progress(), [&](double share) { shares.push_back(share); });
    if (!outcome) continue;
    EXPECT_EQ(outcome, whole);
    EXPECT_EQ(saves, saves_expected) << "after the last save it was done";
    return shares;
  }
  ADD_FAILURE() << "not done after " << saves_expected << " saves";
  return shares;
}

TEST(Estimator, GoesOnToTheSameBytesAfterEveryReplicate) {
  const auto room = blinking_room(4);
  const auto options = options_with(api::DirectLight::pure, api::Interpolated::indirect);
  expect_same_after_every_save(*room, options, {"estimate-lines"}, 2 * kEstimateReplicates);
}

TEST(Estimator, GoesOnToTheSameBytesAfterEveryWindowOfALongSequence) {
  const LitRoom room(kWindowMax + 2, 2.0);
  auto options = options_with(api::DirectLight::pure, api::Interpolated::total);
  options.estimate_patch_edge_m = 2;
  expect_same_after_every_save(room, options, {"estimate-lines"}, 2 * 2 * kEstimateReplicates);
}

TEST(Estimator, GoesOnToTheSameBytesInThePapersModes) {
  const LitRoom room(3);
  auto options = options_with(api::DirectLight::apart, api::Interpolated::total);
  options.mode = api::LightingMode::paper;
  expect_same_after_every_save(room, options, {"estimate-direct", "estimate-lines"},
                               1 + 2 * kEstimateReplicates);
}

// The lamps are two groups, and each is saved when it is lit.
TEST(Estimator, GoesOnToTheSameBytesAfterTheDirectLightOfEveryGroup) {
  const auto room = blinking_room(4);
  const auto options = options_with(api::DirectLight::apart, api::Interpolated::indirect);
  const auto shares = expect_same_after_every_save(*room, options, {"estimate-direct"}, 3);
  EXPECT_EQ(shares, (std::vector<double>{0.5, 1.0}));
}

TEST(Estimator, LeavesNothingBehindThatIsForgottenAndTakesNothingOfAnotherJob) {
  const LitRoom room(3);
  const auto options = options_with(api::DirectLight::apart, api::Interpolated::indirect);
  const tests::TemporaryFolder folder;
  for (const char* name : {"estimate-direct", "estimate-lines"}) {
    StopAfterSave stop(folder, {name});
    Checkpoints files(folder.path() / "checkpoint", "this job", 0ms);
    ASSERT_FALSE(attempt(room, options, &files, stop.progress()));
  }
  const auto lines_found = [&](const char* job) {
    Checkpoints files(folder.path() / "checkpoint", job);
    return begin_estimate(room, options, {}, {&files}).lines_done();
  };
  EXPECT_EQ(lines_found("this job"), static_cast<double>(kFirst) / kEstimateReplicates) << "one replicate";
  EXPECT_EQ(lines_found("another job"), 0);
  EXPECT_EQ(lines_found("this job"), 0) << "what is foreign is removed";

  Checkpoints files(folder.path() / "checkpoint", "this job", 0ms);
  ASSERT_TRUE(files.save("estimate-lines", {}) && files.save(kEstimateDirectName, {}));
  Estimator::forget(files);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "checkpoint"));
}

TEST(Estimator, ProgressRunsFromNothingToAllAndCountsWhatIsLeft) {
  const LitRoom room(3);
  const auto options = options_with(api::DirectLight::pure, api::Interpolated::indirect);
  Estimator estimator = begin_estimate(room, options);
  for (const std::uint64_t lines : {kFirst, kSecond}) {
    std::mutex mutex;
    std::vector<double> fractions;
    const Progress progress{[&](double fraction) {
                              const std::lock_guard lock(mutex);
                              fractions.push_back(fraction);
                            },
                            [] { return false; }};
    ASSERT_TRUE(estimator.add_lines_up_to(lines, progress));
    ASSERT_GT(fractions.size(), 16u);
    EXPECT_LT(*std::min_element(fractions.begin(), fractions.end()), 0.05);
    EXPECT_NEAR(*std::max_element(fractions.begin(), fractions.end()), 1, 1e-12);
    EXPECT_EQ(estimator.lines_done(), static_cast<double>(lines));
  }
}

}  // namespace
}  // namespace engine
