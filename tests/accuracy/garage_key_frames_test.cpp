// The garage: key-frames by interpolation error against Table 1 of Besuievsky & Pueyo, over all patches.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/support/interpolation_truth.h"

namespace tests {
namespace {

constexpr double kTolerance = 0.05;

const ReadyScene& garage() {
  static const Example example = load_example("garage");
  static const ReadyScene ready(example.scene, example.animation, 1.0);
  return ready;
}

api::LightingOptions options_of(api::LightingMode mode, double epsilon = 0.1) {
  api::LightingOptions options;
  options.mode = mode;
  options.line_count = options.moving_line_count = 1'000'000;
  options.tolerance = kTolerance;
  options.epsilon = epsilon;
  return options;
}

/// With the same lines and seed as the reference, so that noise which the solutions share cancels.
InterpolationTruth truth_of(const api::LightingOptions& options) {
  static const auto reference = solve(garage(), options_of(api::LightingMode::reference));
  const InterpolationTruth truth =
      interpolation_truth(garage(), solve(garage(), options), reference, kTolerance);
  std::cout << truth.keys << " keys, " << truth.solved << " frames solved, error: largest "
            << 100 * truth.largest << " %, rms " << 100 * truth.root_mean_square << " %, beyond tolerance "
            << 100 * truth.above << " %, broken and not named: " << truth.unnamed.size() << " intervals\n";
  return truth;
}

}  // namespace

TEST(KeyFramesOfTheGarage, KeepTheToleranceOrNameWhereTheyDoNot) {
  const InterpolationTruth truth = truth_of(options_of(api::LightingMode::standard));
  EXPECT_LE(truth.above, 0.001);
  EXPECT_LE(truth.largest, 2 * kTolerance);
  EXPECT_TRUE(truth.unnamed.empty());
}

// At the thresholds of the paper its largest error is beyond the tolerance, where ours is below. At equal
// true error, the root mean square over patches and frames, ours takes at most half of the keys: Table 1 with
// twice as many as ours must be worse. Its count is met by halving intervals of epsilon.
TEST(KeyFramesOfTheGarage, AreHalfAsManyAsTable1TakesForTheSameError) {
  const InterpolationTruth ours = truth_of(options_of(api::LightingMode::standard));
  EXPECT_LT(ours.largest, kTolerance);
  for (const double epsilon : {0.1, 0.2})
    EXPECT_GT(truth_of(options_of(api::LightingMode::paper, epsilon)).largest, kTolerance);
  double low = 1e-3, high = 1;  // W; counts fall with epsilon
  InterpolationTruth table1;
  for (int step = 0; step < 8; ++step) {
    const double epsilon = std::sqrt(low * high);
    table1 = truth_of(options_of(api::LightingMode::paper, epsilon));
    (table1.solved < 2 * ours.solved ? high : low) = epsilon;
    if (table1.solved == 2 * ours.solved) break;
  }
  EXPECT_GE(table1.solved + 2, 2 * ours.solved) << "the search has not met the count";
  EXPECT_GE(table1.root_mean_square, ours.root_mean_square) << "Table 1 with " << table1.keys << " keys";
}

}  // namespace tests
