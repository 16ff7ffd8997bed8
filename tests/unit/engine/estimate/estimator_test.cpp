// The estimate of the lighting: right on average, and the same bytes however it was come to.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/animation/light_groups.h"
#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/estimate/estimate_lighting.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using namespace std::chrono_literals;
using tests::LitRoom;
using tests::Sample;

api::LightingOptions options_with(api::DirectLight direct, api::Interpolated interpolated,
                                  std::uint64_t seed = 1) {
  api::LightingOptions options;
  options.direct = direct;
  options.interpolated = interpolated;
  options.estimate_patch_edge_m = 1;
  options.seed = seed;
  return options;
}

Estimator begin(const tests::World& world, const api::LightingOptions& options, const Progress& progress = {},
                const EstimateCheckpoints& checkpoints = {}) {
  const auto groups = light_groups(world.scene, world.animation, options.light_groups, kScaledGroupsMax);
  auto estimator = Estimator::begin(world.scene, world.animation, world.static_rays, groups, options,
                                    progress, checkpoints);
  EXPECT_TRUE(estimator);
  return std::move(*estimator);
}

/// Lit by a lamp that blinks, which is a group of its own, and one that does not.
std::unique_ptr<tests::World> blinking_room(FrameIndex frames) {
  Scene scene = tests::lit_room_scene(false);
  scene.materials.push_back({"blinking", {0.1f, 0.1f, 0.1f}, {}, false});
  tests::add_polygon(
      scene, {{-1.4f, -1.0f, 1.8f}, {-1.4f, -0.6f, 1.8f}, {-1.0f, -0.6f, 1.8f}, {-1.0f, -1.0f, 1.8f}}, 0, 3);
  Animation animation = tests::lit_room_animation(scene, frames);
  animation.emission.exitance_w_m2.resize(4);
  for (FrameIndex f = 0; f < frames; ++f)
    animation.emission.exitance_w_m2[3].push_back(Rgb{4, 6, 8} * (f % 3 == 0 ? 0.0f : 1.0f));
  return std::make_unique<tests::World>(scene, animation, 1.0);
}

// ---- Is it right?

/// Area-weighted mean over the patches of an object of what value(patch) says, green.
double mean_over(const tests::World& world, std::uint32_t object, const std::function<Rgb(PatchId)>& value) {
  double sum = 0, area = 0;
  for (PatchId patch = 0; patch < world.patches.count(); ++patch) {
    if (world.patches.facets[world.patches.facet_of[patch]].object != object) continue;
    sum += world.patches.area_m2[patch] * double{value(patch).g};
    area += world.patches.area_m2[patch];
  }
  return sum / area;
}

/// B of one frame, green, [patch]: many lines, one after the other, through this frame alone, and elimination
/// in double. `direct`: H of each patch, or null where lines carry everything.
std::vector<double> reference(const tests::World& world, FrameIndex frame, const DirectLight* direct,
                              std::uint32_t lines, std::uint64_t seed) {
  const tests::Dense t = tests::operator_of(tests::trace_one_frame(world, frame, 0, lines, seed));
  const LitScene lit = world.lit();
  const GroupSource source{&world.animation.emission, direct};
  tests::Dense system(t.size);
  std::vector<double> carried(t.size);
  for (PatchId i = 0; i < t.size; ++i) {
    carried[i] = source.in_frame(lit, i, frame).g;
    const double rho = lit.reflectance(i, frame).g;
    for (PatchId j = 0; j < t.size; ++j) system.at(i, j) = (i == j ? 1 : 0) - rho * t.at(i, j);
  }
  std::vector<double> radiosity = t.times(tests::solve_dense(system, carried));
  for (PatchId i = 0; i < t.size; ++i) {
    const double of_lights = direct ? double{direct->irradiance_w_m2.at(i, frame).g} : 0;
    radiosity[i] = lit.exitance(world.animation.emission, i, frame).g +
                   double{lit.reflectance(i, frame).g} * (radiosity[i] + of_lights);
  }
  return radiosity;
}

constexpr std::array<FrameIndex, 3> kCompared{0, 3, 7};  // the third object is there in the last two

/// Every replicate of `lines` lines against a reference with lines of its own: a paired t-test of what is
/// common to all patches of an object, per frame. Of 10,000 seeds one goes wrong by chance. noise_max: that a
/// standard error may be, relative to B, so that the test means anything.
void expect_unbiased(const LitRoom& room, api::DirectLight direct, std::uint32_t lines, double noise_max) {
  const auto options = options_with(direct, api::Interpolated::total);
  Estimator estimator = begin(room, options);
  ASSERT_TRUE(estimator.add_lines_up_to(lines * kEstimateReplicates, {}));
  Estimate estimate = estimator.estimate();
  ASSERT_EQ(estimate.patches.count(), room.patches.count());
  const DirectLight* lit = direct == api::DirectLight::apart ? &estimate.groups[0].direct : nullptr;
  const double chance = tests::sidak(1e-4, kCompared.size() * 3 - 1);
  for (const FrameIndex frame : kCompared) {
    std::array<Sample, 3> off;
    std::array<double, 3> expected{};
    for (std::uint32_t r = 0; r < kEstimateReplicates; ++r) {
      const auto exact = reference(room, frame, lit, 3 * lines, stream_seed(77, r * 100 + frame));
      for (std::uint32_t object = 0; object < 3; ++object) {
        const double want = mean_over(room, object, [&](PatchId p) {
          return Rgb{0, static_cast<float>(exact[p]), 0};
        });
        expected[object] += want / kEstimateReplicates;
        off[object].add(
            mean_over(room, object,
                      [&](PatchId p) { return estimate.interpolated.of_replicate(p, frame, 0, r); }) -
            want);
      }
    }
    for (std::uint32_t object = 0; object < 3; ++object) {
      if (object == 2 && frame == 0) continue;  // it is not there
      EXPECT_TRUE(tests::agrees(off[object], 0, chance)) << "object " << object << ", frame " << frame;
      EXPECT_LT(off[object].standard_error(), noise_max * expected[object]) << "too noisy to mean anything";
    }
  }
}

TEST(Estimator, IsRightOnAverageWhereLinesCarryEverything) {
  expect_unbiased(LitRoom(8), api::DirectLight::pure, 80'000, 0.05);  // few lines meet the lamp
}

TEST(Estimator, IsRightOnAverageWhereDirectLightIsComputed) {
  expect_unbiased(LitRoom(8), api::DirectLight::apart, 20'000, 0.01);
}

TEST(Estimator, RadiosityIsTheMeanOfTheReplicatesAndNothingIsWhereAnObjectIsNot) {
  const LitRoom room(4);
  const auto options = options_with(api::DirectLight::apart, api::Interpolated::total);
  Estimator estimator = begin(room, options);
  ASSERT_TRUE(estimator.add_lines_up_to(1'600, {}));
  ASSERT_TRUE(estimator.add_lines_up_to(4'800, {}));
  const Estimate& estimate = estimator.estimate();
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (FrameIndex f = 0; f < 4; ++f) {
      const Rgb mean = *estimate.interpolated.at(patch, f), all = estimate.radiosity_w_m2.at(patch, f);
      ASSERT_NEAR(mean.g, all.g, 2e-6 * (1 + all.g)) << patch << " " << f;
      if (room.patches.facets[room.patches.facet_of[patch]].object == 2 && f < 2) {
        ASSERT_EQ(all, Rgb{});
      }
    }
}

// Independent replicates scatter about their mean as that mean does about the truth:
//
//     E (y - mu)^2 = E v,   y = mean of the 8,  v = sum (x_r - y)^2 / 56
//
// The mean of all seeds stands in for mu, which takes 1 / seeds off. Replicates that share lines have v too
// small; were they the same v would be 0, and the mean over the seeds 7 standard errors off.
TEST(Estimator, ReplicatesScatterAsTheirMeanDoes) {
  constexpr int kSeeds = 100;
  const LitRoom room(2);
  std::vector<double> means, variances;
  std::set<double> values;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto options = options_with(api::DirectLight::pure, api::Interpolated::total, seed);
    Estimator estimator = begin(room, options);
    ASSERT_TRUE(estimator.add_lines_up_to(8 * 400, {}));
    Estimate estimate = estimator.estimate();
    Sample of_seed;
    for (std::uint32_t r = 0; r < kEstimateReplicates; ++r) {
      of_seed.add(
          mean_over(room, 0, [&](PatchId p) { return estimate.interpolated.of_replicate(p, 1, 0, r); }));
      values.insert(of_seed.values.back());
    }
    means.push_back(of_seed.mean());
    variances.push_back(of_seed.standard_error() * of_seed.standard_error());
  }
  EXPECT_EQ(values.size(), kSeeds * kEstimateReplicates) << "some replicates are the same";
  double centre = 0;
  for (const double mean : means) centre += mean / kSeeds;
  Sample excess;
  for (int k = 0; k < kSeeds; ++k)
    excess.add((means[k] - centre) * (means[k] - centre) * kSeeds / (kSeeds - 1) - variances[k]);
  EXPECT_TRUE(tests::agrees(excess, 0, 1e-4));
}

/// What the trace of `lines` lines a replicate that came after `before` others found, [patch][frame], green:
/// from B with and without it.
std::vector<double> found_by_second_trace(const tests::World& world, std::uint64_t before,
                                          std::uint64_t lines) {
  const auto options = options_with(api::DirectLight::pure, api::Interpolated::total);
  Estimator estimator = begin(world, options);
  EXPECT_TRUE(estimator.add_lines_up_to(before * kEstimateReplicates, {}));
  const auto without = estimator.estimate().radiosity_w_m2.values;
  EXPECT_TRUE(estimator.add_lines_up_to((before + lines) * kEstimateReplicates, {}));
  const auto with = estimator.estimate().radiosity_w_m2.values;
  EXPECT_EQ(estimator.estimate().line_count, (before + lines) * kEstimateReplicates);
  std::vector<double> found;
  for (std::size_t k = 0; k < with.size(); ++k)
    found.push_back(without[k].g + (double{with[k].g} - without[k].g) * static_cast<double>(before + lines) /
                                       static_cast<double>(lines));
  return found;
}

// The second trace has the same lines whatever the first had, so what it adds must tell the same of it.
// Floats of about 1 are 1e-7 apart, and that is multiplied by 4 at most.
TEST(Estimator, EveryLineCountsTheSameWhicheverStepAddedIt) {
  const LitRoom room(3);
  const auto few = found_by_second_trace(room, 100, 300), many = found_by_second_trace(room, 900, 300);
  double largest = 0;
  for (std::size_t k = 0; k < few.size(); ++k) {
    ASSERT_NEAR(few[k], many[k], 5e-6 * (1 + std::abs(few[k]))) << k;
    largest = std::max(largest, few[k]);
  }
  EXPECT_GT(largest, 1);
}

TEST(Estimator, LinesThatAreThereAreNotAddedAgain) {
  const LitRoom room(3);
  const auto options = options_with(api::DirectLight::pure, api::Interpolated::indirect);
  Estimator estimator = begin(room, options);
  EXPECT_FALSE(estimator.is_beyond(0));
  ASSERT_TRUE(estimator.add_lines_up_to(803, {}));
  EXPECT_EQ(estimator.estimate().line_count, 800u) << "an equal part to every replicate";
  EXPECT_TRUE(estimator.is_beyond(799));
  EXPECT_FALSE(estimator.is_beyond(800));
  const auto before = estimator.estimate().interpolated.values;
  ASSERT_TRUE(estimator.add_lines_up_to(800, {}));
  EXPECT_EQ(estimator.estimate().interpolated.values, before);
}

TEST(Estimator, LinesThatAreAddedAreOthersThanThoseBefore) {
  const LitRoom room(2);
  const auto options = options_with(api::DirectLight::pure, api::Interpolated::total);
  Estimator estimator = begin(room, options);
  ASSERT_TRUE(estimator.add_lines_up_to(1'600, {}));
  const auto once = estimator.estimate().interpolated.values;
  ASSERT_TRUE(estimator.add_lines_up_to(3'200, {}));
  std::size_t other = 0;
  for (std::size_t k = 0; k < once.size(); ++k)
    other += std::abs(once[k].g - estimator.estimate().interpolated.values[k].g) > 0.01f ? 1 : 0;
  EXPECT_GT(other, once.size() / 4);
}

TEST(Estimator, ManyLinesAreTracedInEvenPartsThatFitIntoMemory) {
  for (const std::uint64_t all : {std::uint64_t{1}, kEstimateLinesPerTraceMax, kEstimateLinesPerTraceMax + 1,
                                  7 * kEstimateLinesPerTraceMax / 2, std::uint64_t{100'000'000}}) {
    std::uint64_t left = all, traces = 0, most = 0, least = all;
    for (; left > 0; ++traces) {
      const std::uint64_t lines = lines_of_next_trace(left);
      ASSERT_GT(lines, 0u);
      ASSERT_LE(lines, left);
      left -= lines;
      most = std::max(most, lines);
      least = std::min(least, lines);
    }
    EXPECT_LE(most, kEstimateLinesPerTraceMax);
    EXPECT_LE(most - least, 1u);
    EXPECT_EQ(traces, (all + kEstimateLinesPerTraceMax - 1) / kEstimateLinesPerTraceMax);
  }
}

TEST(Estimator, OnlyModeDefaultKeepsReplicates) {
  const LitRoom room(3);
  auto options = options_with(api::DirectLight::apart, api::Interpolated::total);
  options.mode = api::LightingMode::paper;
  Estimator paper = begin(room, options);
  ASSERT_TRUE(paper.add_lines_up_to(800, {}));
  EXPECT_TRUE(paper.estimate().interpolated.values.empty());
  const auto standard_options = options_with(api::DirectLight::apart, api::Interpolated::total);
  Estimator standard = begin(room, standard_options);
  ASSERT_TRUE(standard.add_lines_up_to(800, {}));
  EXPECT_EQ(paper.estimate().radiosity_w_m2.values, standard.estimate().radiosity_w_m2.values);
}

// ---- Is it the same however it was come to?

/// What an estimate comes to.
struct Outcome {
  std::vector<Rgb> radiosity, interpolated;
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
    return begin(room, options, {}, {&files}).lines_done();
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
  Estimator estimator = begin(room, options);
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
