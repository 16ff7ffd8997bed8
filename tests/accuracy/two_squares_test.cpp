// Two squares a x a face to face at distance c in black surroundings, one patch each; the lower one emits.
#include <gtest/gtest.h>

#include "tests/support/lit.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

constexpr std::uint64_t kSeeds = 24;
constexpr float kReflectance = 0.5f;

/// One false alarm in 10,000 choices of seeds: 2 scenes x 2 ways of the first light x 2 answers.
constexpr double kFalseAlarm = 1e-4 / 8;

SceneBuilder two_squares(float a, float c) {
  SceneBuilder built;
  const engine::Rgb rho{kReflectance, kReflectance, kReflectance};
  built.add_polygon({{0, 0, 0}, {a, 0, 0}, {a, a, 0}, {0, a, 0}}, built.add_material(rho, {1, 1, 1}));
  built.add_polygon({{0, 0, c}, {0, a, c}, {a, a, c}, {a, 0, c}}, built.add_material(rho));
  return built;
}

/// B1 = E / (1 - rho^2 F^2), B2 = rho F B1.
void expect_exact(const SceneBuilder& built, double b1, double b2, api::DirectLight direct) {
  const ReadyScene ready(built, 1e4);
  ASSERT_EQ(ready.patches.count(), 2u);
  api::LightingOptions options;
  options.direct = direct;
  options.line_count = 65'536;
  options.samples_per_light = 256;
  Sample lower, upper;
  for (options.seed = 1; options.seed <= kSeeds; ++options.seed) {
    const LitFrames lit = light_frames(ready, {0}, options);
    lower.add(lit.radiosity.at(0, 0).r);
    upper.add(lit.radiosity.at(1, 0).r);
  }
  // The iteration stops within 1e-5 rho / (1 - rho) = 1e-5 of the mean source, 1/2 at most; single precision
  // adds 1e-7 per operation.
  constexpr double kIteration = 5e-6 + 1e-6;
  EXPECT_TRUE(agrees(lower, b1, kFalseAlarm, kIteration));
  EXPECT_TRUE(agrees(upper, b2, kFalseAlarm, kIteration));
  EXPECT_LT(upper.standard_error(), 1e-3 * b2) << "too noisy to mean anything";
}

}  // namespace

TEST(TwoSquares, RadiosityIsExactAsFarApartAsTheyAreWide) {
  for (const auto direct : {api::DirectLight::apart, api::DirectLight::pure})
    expect_exact(two_squares(1, 1), 1.0100831522749245, 0.10091988027501761, direct);
}

TEST(TwoSquares, RadiosityIsExactAHundredTimesAsWideAsApart) {
  for (const auto direct : {api::DirectLight::apart, api::DirectLight::pure})
    expect_exact(two_squares(100, 1), 1.3163163099291422, 0.645269182478391, direct);
}

}  // namespace tests
