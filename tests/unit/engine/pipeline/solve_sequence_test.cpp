#include "engine/pipeline/solve_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/lighting/compose.h"
#include "engine/pipeline/frame_by_frame.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/light_indirectly.h"
#include "tests/unit/engine/pipeline/solve_room.h"

namespace engine {
namespace {

using api::FrameKind;
using api::LightingMode;
using tests::BlinkingRoom;
using tests::LitRoom;
using tests::quick_options;
using tests::Solution;
using tests::solve;

constexpr LightingMode kModes[] = {LightingMode::standard, LightingMode::paper, LightingMode::paper_literal,
                                   LightingMode::reference, LightingMode::frame_by_frame};

TEST(SolveSequence, HasStandardErrorsInEveryModeUnlessTheyAreNotAskedFor) {
  const LitRoom room(6);
  for (const LightingMode mode : kModes) {
    api::LightingOptions options = quick_options(mode);
    const Solution with = solve(room.lit(), options);
    const PatchSeries* errors = standard_error_of(with.sequence);
    ASSERT_TRUE(errors);
    EXPECT_EQ(errors->patch_count, room.patches.count());
    EXPECT_EQ(errors->frame_count, 6u);
    const double mean = mean_radiosity(room.lit(), with.sequence.radiosity_w_m2);
    EXPECT_NEAR(with.report.noise.value(), root_mean_square_error(room.lit(), *errors) / mean, 1e-6);
    EXPECT_GT(*with.report.noise, 0.001);
    EXPECT_FALSE(with.report.target_error);
    options.standard_errors = false;
    const Solution without = solve(room.lit(), options);
    EXPECT_FALSE(standard_error_of(without.sequence));
    EXPECT_TRUE(without.sequence.others.empty());
    EXPECT_FALSE(without.report.noise);
  }
}

TEST(SolveSequence, WhatIsNotThereIsDarkAndHasNoError) {
  const LitRoom room(10);
  for (const LightingMode mode : {LightingMode::standard, LightingMode::reference}) {
    const Solution solution = solve(room.lit(), quick_options(mode));
    const PatchSeries* errors = standard_error_of(solution.sequence);
    ASSERT_TRUE(errors);
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      for (FrameIndex f = 0; f < 10; ++f) {
        const bool gone =
            room.patches.facets[room.patches.facet_of[patch]].object == 2 && f != 2 && f != 3 && f != 7;
        ASSERT_EQ(solution.sequence.radiosity_w_m2.at(patch, f) == Rgb{}, gone) << patch << " " << f;
        if (gone) {
          ASSERT_EQ(errors->at(patch, f), Rgb{});
        }
      }
  }
}

TEST(SolveSequence, ATargetErrorIsMetByMoreLinesAndReported) {
  const LitRoom room(5);
  for (const LightingMode mode : {LightingMode::standard, LightingMode::reference}) {
    api::LightingOptions options = quick_options(mode);
    options.samples_per_light = 64;  // so that lines make most of the noise
    options.line_count = options.moving_line_count = 2'000;
    const double before = *solve(room.lit(), options).report.noise;
    options.target_error = before / 3;
    const Solution solution = solve(room.lit(), options);
    EXPECT_EQ(solution.report.target_error, options.target_error);
    EXPECT_EQ(solution.report.target_error_met, true);
    EXPECT_LE(*solution.report.noise, *options.target_error);
    EXPECT_GT(*solution.report.noise, 0.3 * *options.target_error) << "far more work than asked for";
    EXPECT_GT(solution.count("lines"), 3 * 2'000);
    EXPECT_TRUE(solution.report.warnings.empty());
    // Without the artefact the noise is known all the same.
    options.standard_errors = false;
    const Solution quiet = solve(room.lit(), options);
    EXPECT_TRUE(quiet.sequence.others.empty());
    EXPECT_EQ(quiet.report.noise, solution.report.noise);
    EXPECT_EQ(quiet.sequence.radiosity_w_m2.values, solution.sequence.radiosity_w_m2.values);
  }
}

TEST(SolveSequence, ATargetErrorThatIsMetAtOnceChangesNothing) {
  const LitRoom room(5);
  api::LightingOptions options = quick_options();
  const Solution plain = solve(room.lit(), options);
  options.target_error = 1.0;
  const Solution easy = solve(room.lit(), options);
  EXPECT_EQ(easy.report.target_error_met, true);
  EXPECT_EQ(easy.sequence.radiosity_w_m2.values, plain.sequence.radiosity_w_m2.values);
}

/// The smallest target there is, of which the report must say that it was not met, and why.
Solution solve_for_too_much(const tests::World& room, api::LightingOptions options, const std::string& why) {
  options.target_error = 1e-4;
  const Solution solution = solve(room.lit(), options);
  EXPECT_EQ(solution.report.target_error, 1e-4);
  EXPECT_EQ(solution.report.target_error_met, false);
  EXPECT_GT(solution.report.noise.value_or(0), 1e-4);
  EXPECT_EQ(solution.report.warnings.size(), 1u);
  for (const std::string& warning : solution.report.warnings) {
    EXPECT_NE(warning.find("more than the target error"), warning.npos) << warning;
    EXPECT_NE(warning.find(why), warning.npos) << warning;
  }
  return solution;
}

// Both limits end the work: that of shadow rays, after which no line could help, and that of replicates of
// lines where these carry all light.
TEST(SolveSequence, ATargetErrorThatCannotBeMetEndsAtTheLimitsAndIsSaidNotToBeMet) {
  const LitRoom room(3);
  for (const LightingMode mode : {LightingMode::standard, LightingMode::reference}) {
    api::LightingOptions options = quick_options(mode);
    options.line_count = options.moving_line_count = 1'000;
    const Solution before = solve(room.lit(), options);
    const Solution shadowed = solve_for_too_much(room, options, "limits on lines and samples");
    EXPECT_GT(shadowed.count("light_samples"), 100 * before.count("light_samples"));
    EXPECT_LE(shadowed.count("light_samples"),
              1.01 * kSamplesPerLightMax / options.samples_per_light * before.count("light_samples"));
    options.direct = api::DirectLight::pure;
    const double lines_before = solve(room.lit(), options).count("lines");
    const Solution pure = solve_for_too_much(room, options, "limits on lines and samples");
    EXPECT_EQ(pure.count("lines"), kReplicatesMax / replicates_of(options) * lines_before);
  }
}

TEST(SolveSequence, FrameByFrameSaysThatATargetErrorIsNotMetAndAddsNothing) {
  const LitRoom room(3);
  const api::LightingOptions options = quick_options(LightingMode::frame_by_frame);
  const Solution plain = solve(room.lit(), options);
  const Solution asked = solve_for_too_much(room, options, "as they are given");
  EXPECT_EQ(asked.report.counts, plain.report.counts);
  EXPECT_EQ(asked.sequence.radiosity_w_m2.values, plain.sequence.radiosity_w_m2.values);
}

/// The groups of lights of `options` against the whole, which is up to 20 W/m^2.
void expect_sum_of_groups(const tests::World& room, api::LightingOptions options) {
  options.light_groups = {{"lamps", {"lamp"}}};
  options.standard_errors = false;
  const Solution solution = solve(room.lit(), options);
  const PatchSeries *lamps = solution.series("radiosity_lamps.npy"),
                    *other = solution.series("radiosity_other.npy");
  ASSERT_TRUE(lamps && other);
  double largest = 0;
  for (std::size_t k = 0; k < lamps->values.size(); ++k) {
    const Rgb whole = solution.sequence.radiosity_w_m2.values[k], sum = lamps->values[k] + other->values[k];
    largest = std::max(largest, double{max_channel(lamps->values[k])});
    ASSERT_NEAR(sum.r, whole.r, 1e-5 * std::max(1.0f, whole.r));
    ASSERT_NEAR(sum.g, whole.g, 1e-5 * std::max(1.0f, whole.g));
    ASSERT_NEAR(sum.b, whole.b, 1e-5 * std::max(1.0f, whole.b));
  }
  EXPECT_GT(largest, 1);
}

TEST(SolveSequence, GroupsOfLightsAddUpToTheWholeInModeDefault) {
  const BlinkingRoom room(12);
  for (const auto interpolation : {api::Interpolation::linear, api::Interpolation::monotone_cubic}) {
    api::LightingOptions options = quick_options();
    options.interpolation = interpolation;
    options.tolerance = 0.3;  // leaves frames to interpolate
    expect_sum_of_groups(room, options);
  }
}

TEST(SolveSequence, GroupsOfLightsAddUpToTheWholeWhereEveryFrameIsSolved) {
  const BlinkingRoom room(12);
  expect_sum_of_groups(room, quick_options(LightingMode::reference));
}

TEST(SolveSequence, GroupsOfLightsAddUpToTheWholeWhereAllLightIsInterpolated) {
  const BlinkingRoom room(12);
  for (const auto interpolation : {api::Interpolation::linear, api::Interpolation::monotone_cubic}) {
    api::LightingOptions options = quick_options();
    options.interpolated = api::Interpolated::total;
    options.interpolation = interpolation;
    options.tolerance = 0.5;
    expect_sum_of_groups(room, options);
    options = quick_options(LightingMode::paper);
    options.interpolation = interpolation;
    options.epsilon = 1;
    expect_sum_of_groups(room, options);
  }
}

TEST(SolveSequence, GroupsOfLightsAddUpToTheWholeWhereLinesCarryEverything) {
  const BlinkingRoom room(8);
  api::LightingOptions options = quick_options();
  options.direct = api::DirectLight::pure;
  expect_sum_of_groups(room, options);
}

// Light is linear in what emits. Each of the three solutions ends within 1e-5 of its mean B
// (kIterationError), and as much again is left for rounding.
TEST(SolveSequence, AWeightedSumOfGroupsIsTheSolutionUnderLightsOfTheseWeights) {
  const auto room_lit = [](float lamp, float coloured) {
    Animation animation = tests::lit_room_animation(tests::lit_room_scene(false), 6);
    animation.emission.exitance_w_m2 = {{{}}, {lamp * Rgb{10, 8, 5}}, {coloured * Rgb{1, 2, 3}}};
    return animation;
  };
  const tests::World room(tests::lit_room_scene(false), room_lit(1, 1), 1.0);
  const tests::World relit(tests::lit_room_scene(false), room_lit(0.25f, 3), 1.0);
  api::LightingOptions options = quick_options(LightingMode::reference);
  options.standard_errors = false;
  const PatchSeries wanted = solve(relit.lit(), options).sequence.radiosity_w_m2;
  options.light_groups = {{"lamps", {"lamp"}}, {"things", {"coloured"}}};
  const Solution solution = solve(room.lit(), options);
  const PatchSeries *lamps = solution.series("radiosity_lamps.npy"),
                    *things = solution.series("radiosity_things.npy");
  ASSERT_TRUE(lamps && things);
  const double allowed =
      2e-5 * (0.25 * mean_radiosity(room.lit(), *lamps) + 3 * mean_radiosity(room.lit(), *things) +
              mean_radiosity(room.lit(), wanted));
  for (std::size_t k = 0; k < wanted.values.size(); ++k) {
    const Rgb sum = 0.25f * lamps->values[k] + 3.0f * things->values[k];
    ASSERT_NEAR(sum.r, wanted.values[k].r, allowed);
    ASSERT_NEAR(sum.g, wanted.values[k].g, allowed);
    ASSERT_NEAR(sum.b, wanted.values[k].b, allowed);
  }
  EXPECT_GT(mean_radiosity(room.lit(), *lamps), 100 * allowed);
  EXPECT_GT(mean_radiosity(room.lit(), *things), 100 * allowed);
}

// Lines and samples of their own in 8 replicates: of the differences over their standard errors, which have
// about 14 degrees of freedom, 1 % are beyond 3 by chance. Patches see each other and frames share their
// noise, so that the count of such varies more than if they were independent; 5 % would be no chance. (With
// a sample per replicate instead of 32 a patch may be shadowed in all of 8 by chance, and seem to be sure.)
TEST(SolveSequence, FrameByFrameIsTheReferenceWithinTheNoise) {
  const LitRoom room(8);
  api::LightingOptions options = quick_options(LightingMode::reference);
  options.samples_per_light = 256;
  options.line_count = options.moving_line_count = 64'000;
  const Solution reference = solve(room.lit(), options);
  options.mode = LightingMode::frame_by_frame;
  options.seed = 99;
  const Solution alone = solve(room.lit(), options);
  const PatchSeries &a = reference.sequence.radiosity_w_m2, &b = alone.sequence.radiosity_w_m2;
  const PatchSeries &of_a = *standard_error_of(reference.sequence),
                    &of_b = *standard_error_of(alone.sequence);
  int beyond = 0, all = 0;
  double sum_a = 0, sum_b = 0;
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    const double noise = std::hypot(of_a.values[k].g, of_b.values[k].g);
    sum_a += a.values[k].g;
    sum_b += b.values[k].g;
    if (noise == 0) continue;
    ++all;
    beyond += std::abs(double{a.values[k].g} - b.values[k].g) > 3 * noise ? 1 : 0;
  }
  EXPECT_GT(all, 400);
  EXPECT_LT(beyond, 0.05 * all);
  EXPECT_NEAR(sum_a / sum_b, 1, 3 * (*reference.report.noise + *alone.report.noise) / std::sqrt(8));
}

// The same lines for all, the same samples, and nothing that moves: each within kIterationError of the mean
// B. Where standard errors are wanted, the noise of direct light takes another way, at rest or as a
// difference with lines of its own.
TEST(SolveSequence, OfAStaticSceneFrameByFrameIsTheReference) {
  const LitRoom moving(4);
  const tests::World room(
      moving.scene,
      [&] {
        Animation animation = tests::lit_room_animation(moving.scene, 4);
        for (ObjectMotion& motion : animation.objects) motion.spans = {{0, 3, tests::moved_to(0, 0, 0.3)}};
        return animation;
      }(),
      1.0);
  api::LightingOptions options = quick_options(LightingMode::reference);
  options.moving_line_count = options.line_count;
  options.standard_errors = false;
  const Solution reference = solve(room.lit(), options);
  options.mode = LightingMode::frame_by_frame;
  const Solution alone = solve(room.lit(), options);
  const double allowed = 2e-5 * mean_radiosity(room.lit(), reference.sequence.radiosity_w_m2);
  const auto largest = [](const PatchSeries& a, const PatchSeries& b) {
    float by = 0;
    for (std::size_t k = 0; k < a.values.size(); ++k) {
      const Rgb off = a.values[k] - b.values[k];
      by = std::max({by, std::abs(off.r), std::abs(off.g), std::abs(off.b)});
    }
    return by;
  };
  EXPECT_LE(largest(reference.sequence.radiosity_w_m2, alone.sequence.radiosity_w_m2), allowed);
}

TEST(SolveSequence, TheReferenceSolvesEveryFrameAndInterpolatesNone) {
  const LitRoom room(6);
  const Solution solution = solve(room.lit(), quick_options(LightingMode::reference));
  for (const api::FrameRecord& record : solution.sequence.key_frames.frames)
    EXPECT_EQ(record.kind, FrameKind::key);
  EXPECT_EQ(solution.count("key_frames"), 6);
  EXPECT_EQ(solution.count("check_frames"), 0);
}

TEST(SolveSequence, OneFrameIsEnough) {
  const LitRoom room(1);
  for (const LightingMode mode : kModes) {
    const Solution solution = solve(room.lit(), quick_options(mode));
    EXPECT_EQ(solution.sequence.radiosity_w_m2.frame_count, 1u);
    EXPECT_GT(mean_radiosity(room.lit(), solution.sequence.radiosity_w_m2), 0.1);
  }
}

}  // namespace
}  // namespace engine
