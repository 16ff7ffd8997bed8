// Every patch, channel and frame of three scenes with occluders against a solution without chance.
#include "tests/support/dense_radiosity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "engine/pipeline/solve_sequence.h"
#include "tests/support/occluded_scenes.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;
using engine::Rgb;

constexpr std::uint64_t kSeeds = 64;

/// All three scenes together refuse a correct engine for one choice of seeds in a thousand.
const double kFalseAlarm = sidak(1e-3, 3);

constexpr std::array<float Rgb::*, 3> kChannels{&Rgb::r, &Rgb::g, &Rgb::b};

/// By the engine, every frame solved; all light but the direct by lines.
engine::PatchSeries solved_by_engine(const ReadyScene& ready, std::uint64_t seed) {
  api::LightingOptions options;
  options.mode = api::LightingMode::reference;
  options.line_count = options.moving_line_count = 200'000;
  options.samples_per_light = 64;
  options.seed = seed;
  api::JobReport report;
  const engine::RunHooks hooks;
  engine::StageClock clock(hooks, report);
  return engine::solve_sequence(ready.lit, options, clock, report)->radiosity_w_m2;
}

/// t-tests of all patches, channels and frames of one scene.
void expect_dense(const SceneBuilder& built, double patch_edge_m) {
  const ReadyScene ready(built, patch_edge_m);
  const std::uint32_t frames = ready.animation.frame_count, patches = ready.patches.count();
  std::vector<Sample> found(std::size_t{patches} * frames * 3);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const engine::PatchSeries solved = solved_by_engine(ready, seed);
    for (std::size_t k = 0; k < solved.values.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) found[3 * k + c].add(solved.values[k].*kChannels[c]);
  }
  const double false_alarm = sidak(kFalseAlarm, found.size());
  double largest_t = 0, quadrature_per_error = 0, error_per_value = 0;
  for (FrameIndex f = 0; f < frames; ++f) {
    const DenseRadiosity exact = dense_radiosity(ready, f, 1e-5);
    double mean = 0;
    for (const auto& b : exact.radiosity_w_m2) mean += b[0] / patches;
    // The engine's iteration stops within 1e-5 rho / (1 - rho) <= 4e-5 of the mean B, and rounds to single
    // precision.
    for (PatchId p = 0; p < patches; ++p)
      for (std::size_t c = 0; c < 3; ++c) {
        const Sample& sample = found[3 * (std::size_t{p} * frames + f) + c];
        const double value = exact.radiosity_w_m2[p][c], error = sample.standard_error();
        const double systematic = exact.error_w_m2[p][c] + 4e-5 * mean + 3e-7 * value;
        EXPECT_TRUE(agrees(sample, value, false_alarm, systematic))
            << "patch " << p << ", channel " << c << ", frame " << f;
        if (error == 0) continue;
        largest_t = std::max(largest_t, std::abs(sample.mean() - value) / error);
        quadrature_per_error = std::max(quadrature_per_error, exact.error_w_m2[p][c] / error);
        error_per_value = std::max(error_per_value, error / value);
      }
  }
  EXPECT_LT(quadrature_per_error, 0.5) << "the exact answer must be exact beside the noise";
  EXPECT_LT(error_per_value, 0.02) << "too noisy to mean anything";
  testing::Test::RecordProperty("largest_t", std::to_string(largest_t));
  std::cout << patches << " patches x " << frames << " frames: largest |t| " << largest_t
            << ", one comparison refused at p < " << false_alarm << "; quadrature at most "
            << quadrature_per_error << " standard errors; standard error at most " << 100 * error_per_value
            << " % of B\n";
}

}  // namespace

// The solver of the exact answers itself, in a closed scene: from every point all that is seen adds up to
// one, whatever hides what (each point is exact; only rounding is left), and A_i F_ij = A_j F_ji, which the
// quadrature alone can break.
TEST(DenseFormFactors, AddUpToOneAndAreReciprocal) {
  SceneBuilder built;
  const auto paint = built.add_material({});
  built.add_box({0, 0, 0}, {3, 2, 2}, true, paint);
  built.add_box({0.5f, 0.9f, 0.3f}, {1.1f, 1.5f, 1.1f}, false, paint);
  const auto turned = built.add_object({{{0, 0, turned_and_moved(0.4, 2.1, 0.8, 0.7)}}});
  built.add_box({-0.35f, -0.3f, -0.3f}, {0.35f, 0.3f, 0.3f}, false, paint, turned);
  const ReadyScene ready(built, 0.7);
  const FormFactors factors = dense_form_factors(ready, 0, 4);
  double not_reciprocal = 0, off_one = 0;
  for (PatchId i = 0; i < ready.patches.count(); ++i) {
    double sum = 0;
    for (PatchId j = 0; j < ready.patches.count(); ++j) {
      sum += factors.at(i, j);
      not_reciprocal = std::max(not_reciprocal, std::abs(ready.patches.area_m2[i] * factors.at(i, j) -
                                                         ready.patches.area_m2[j] * factors.at(j, i)));
    }
    off_one = std::max(off_one, std::abs(sum - 1));
  }
  EXPECT_LT(off_one, 1e-5);
  EXPECT_LT(not_reciprocal, 1e-4) << "of patches of .1 to .5 m^2";
  std::cout << "off one by " << off_one << ", off reciprocity by " << not_reciprocal << " m^2\n";
}

TEST(DenseFormFactors, OfACubeAreThoseOfTheCatalogue) {
  SceneBuilder built;
  built.add_box({0, 0, 0}, {1, 1, 1}, true, built.add_material({}));
  const ReadyScene ready(built, 2.0);
  const FormFactors factors = dense_form_factors(ready, 0, 8);
  EXPECT_NEAR(factors.at(4, 5), 0.19982489569838746, 1e-6);
  EXPECT_NEAR(factors.at(4, 0), 0.20004377607540316, 2e-5);
}

TEST(DenseRadiosity, IsMetByEveryPatchAndFrameWithABlockThatMoves) {
  expect_dense(blocks_of_which_one_moves(), 0.7);
}

TEST(DenseRadiosity, IsMetByBothSidesOfAnOpenSheet) {
  expect_dense(open_sheet(), 0.5);
}

TEST(DenseRadiosity, IsMetInEveryColour) {
  expect_dense(coloured_blocks(), 0.7);
}

}  // namespace tests
