// What interpolating costs on the garage: against every frame solved with the same lines, so that noise which
// the solutions share cancels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/pipeline/solve_sequence.h"
#include "tests/support/lit.h"

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;
using engine::Rgb;

const ReadyScene& garage() {
  static const Example example = load_example("garage");
  static const ReadyScene ready(example.scene, example.animation, 1.0);
  return ready;
}

engine::SolvedSequence solved_by(api::LightingMode mode) {
  api::LightingOptions options;
  options.mode = mode;
  options.line_count = 2'000'000;
  options.tolerance = 0.05;
  options.epsilon = 0.1;
  api::JobReport report;
  const engine::RunHooks hooks;
  engine::StageClock clock(hooks, report);
  return *engine::solve_sequence(garage().lit, options, clock, report);
}

bool emits(PatchId patch) {
  return engine::max_channel(engine::exitance_of_patch(garage().lit, patch, 0)) > 0;
}

double difference(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// Area-weighted mean B over patches that do not emit, and frames.
double mean_radiosity(const engine::PatchSeries& radiosity) {
  double sum = 0, area = 0;
  for (PatchId p = 0; p < radiosity.patch_count; ++p)
    for (FrameIndex f = 0; f < radiosity.frame_count && !emits(p); ++f) {
      sum += double{garage().patches.area_m2[p]} * engine::max_channel(radiosity.at(p, f));
      area += garage().patches.area_m2[p];
    }
  return sum / area;
}

/// Of patches at rest that do not emit.
struct Errors {
  double root_mean_square = 0;   ///< area-weighted, relative to the mean B
  double above_tolerance = 0;    ///< share of patches and frames with e(i, f) over 5 %
  double largest_in_solved = 0;  ///< e(i, f) of frames that were solved
  std::size_t solved = 0;        ///< frames
};

Errors errors_of(const engine::SolvedSequence& found, const engine::SolvedSequence& reference) {
  const double mean = mean_radiosity(reference.radiosity_w_m2);
  double squares = 0, area = 0, above = 0, count = 0;
  Errors errors;
  for (const api::FrameRecord& record : found.key_frames.frames) {
    const bool solved = record.kind != api::FrameKind::interpolated;
    errors.solved += solved;
    for (PatchId p = 0; p < garage().patches.count(); ++p) {
      if (emits(p) || garage().moves(p)) continue;
      const Rgb exact = reference.radiosity_w_m2.at(p, record.frame);
      const double off = difference(found.radiosity_w_m2.at(p, record.frame), exact);
      const double error = off / std::max<double>(engine::max_channel(exact), 0.5 * mean);
      squares += garage().patches.area_m2[p] * off * off;
      area += garage().patches.area_m2[p];
      above += error > 0.05;
      count += 1;
      if (solved) errors.largest_in_solved = std::max(errors.largest_in_solved, error);
    }
  }
  errors.root_mean_square = std::sqrt(squares / area) / mean;
  errors.above_tolerance = above / count;
  return errors;
}

}  // namespace

// The tolerance of 5 % bounds the largest error on the estimate's patches of 2 m. Where the plane passes
// close to finer ones, indirect light is sharper than the estimate can see: a few patches at rest exceed it,
// by hand up to 20 % on patches of .5 m. So the largest error is not asserted, nor are moving patches, which
// few lines meet. What must hold: solved frames are those of the reference; the error as a whole is far below
// its bound; and it is exceeded rarely (less than once in 2,000 patches and frames here; ten times that is
// refused).
TEST(KeyFramesByError, KeepTheIndirectLightOfPatchesAtRest) {
  const auto reference = solved_by(api::LightingMode::reference);
  const Errors errors = errors_of(solved_by(api::LightingMode::standard), reference);
  // Two iterations, each within 2.4e-5 of the mean source, over half the mean B; and sums in single
  // precision.
  EXPECT_LT(errors.largest_in_solved, 2e-4);
  EXPECT_LT(errors.solved, 60u) << "keys and checks: else nothing is saved";
  EXPECT_LT(errors.root_mean_square, 0.05 / 4);
  EXPECT_LT(errors.above_tolerance, 0.005);

  // Table 1 interpolates direct light too, and bounds something else: with more frames solved it is worse.
  const Errors table1 = errors_of(solved_by(api::LightingMode::paper), reference);
  EXPECT_GT(table1.solved, errors.solved);
  EXPECT_GT(table1.root_mean_square, errors.root_mean_square);
}

}  // namespace tests
