// The estimate of the lighting: right on average, whichever steps its lines were added in.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "engine/base/sobol.h"
#include "tests/support/statistics.h"
#include "tests/unit/engine/estimate/estimating.h"

namespace engine {
namespace {

using tests::begin_estimate;
using tests::LitRoom;
using tests::options_with;
using tests::Sample;

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
  Estimator estimator = begin_estimate(room, options);
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
  Estimator estimator = begin_estimate(room, options);
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
    Estimator estimator = begin_estimate(room, options);
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
  Estimator estimator = begin_estimate(world, options);
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
  Estimator estimator = begin_estimate(room, options);
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
  Estimator estimator = begin_estimate(room, options);
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
  Estimator paper = begin_estimate(room, options);
  ASSERT_TRUE(paper.add_lines_up_to(800, {}));
  EXPECT_TRUE(paper.estimate().interpolated.values.empty());
  const auto standard_options = options_with(api::DirectLight::apart, api::Interpolated::total);
  Estimator standard = begin_estimate(room, standard_options);
  ASSERT_TRUE(standard.add_lines_up_to(800, {}));
  EXPECT_EQ(paper.estimate().radiosity_w_m2.values, standard.estimate().radiosity_w_m2.values);
}

}  // namespace
}  // namespace engine
