// The promise to the user: interpolation is within the tolerance, and where it is not the report says so. On
// eight animations of different kinds, over all patches, moving ones too; the reference shares the lines and
// their noise, so there is no chance in the comparison.
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <iostream>

#include "tests/support/animated_scenes.h"
#include "tests/support/interpolation_truth.h"

namespace tests {
namespace {

constexpr double kTolerance = 0.05;
constexpr double kPatchEdge_m = 0.5;

api::LightingOptions options_of(api::LightingMode mode) {
  api::LightingOptions options;
  options.mode = mode;
  options.tolerance = kTolerance;
  options.line_count = options.moving_line_count = 400'000;
  options.estimate_line_count = 200'000;
  return options;
}

void print(const std::string& name, const InterpolationTruth& truth) {
  std::cout << std::left << std::setw(22) << name << std::right << std::setw(4) << truth.keys << " keys "
            << std::setw(4) << truth.solved << " solved  largest " << std::setw(7) << std::setprecision(3)
            << 100 * truth.largest << " %  above tolerance " << std::setw(7) << 100 * truth.above
            << " %  rms " << std::setw(7) << 100 * truth.root_mean_square << " %  broken and not named:";
  for (const std::string& interval : truth.unnamed) std::cout << ' ' << interval;
  std::cout << "  named in vain:";
  for (const std::string& interval : truth.named_in_vain) std::cout << ' ' << interval;
  std::cout << '\n';
}

class Tolerance : public testing::TestWithParam<std::size_t> {
 protected:
  const AnimatedScene scene_ = animated_scenes()[GetParam()];
};

std::string name_of(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = animated_scenes()[info.param].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

}  // namespace

TEST_P(Tolerance, IsKeptOrTheReportNamesWhereItIsNot) {
  const ReadyScene ready(scene_.built, kPatchEdge_m);
  const auto reference = solve(ready, options_of(api::LightingMode::reference));
  const auto found = solve(ready, options_of(api::LightingMode::standard));
  const InterpolationTruth truth = interpolation_truth(ready, found, reference, kTolerance);
  print(scene_.name, truth);
  EXPECT_LE(truth.above, 0.001);
  EXPECT_LE(truth.largest, 2 * kTolerance);
  EXPECT_TRUE(truth.unnamed.empty()) << truth.unnamed.size() << " intervals";
}

// Noise makes no keys: a quarter of the lines, of the estimate's too, and the count stays within one or 10 %.
TEST_P(Tolerance, TakesAsManyKeysWithAQuarterOfTheLines) {
  const ReadyScene ready(scene_.built, kPatchEdge_m);
  const auto keys = [&](std::uint64_t divisor) {
    api::LightingOptions options = options_of(api::LightingMode::standard);
    options.line_count /= divisor;
    options.moving_line_count /= divisor;
    options.estimate_line_count /= divisor;
    const auto frames = solve(ready, options).key_frames.frames;
    return static_cast<double>(
        std::count_if(frames.begin(), frames.end(),
                      [](const api::FrameRecord& record) { return record.kind == api::FrameKind::key; }));
  };
  const double all = keys(1), quarter = keys(4);
  std::cout << scene_.name << ": " << all << " keys, with a quarter of the lines " << quarter << '\n';
  EXPECT_LE(std::abs(quarter - all), std::max(1.0, 0.1 * all));
}

INSTANTIATE_TEST_SUITE_P(Animations, Tolerance, testing::Range<std::size_t>(0, 8), name_of);

}  // namespace tests
