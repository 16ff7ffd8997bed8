// A closed cube, one patch per face, one face emits: three unknowns (source, opposite, sides), solved by
// hand from the closed form factors of a cube.
#include <gtest/gtest.h>

#include <array>

#include "tests/support/lit.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

struct CubeCase {
  float reflectance;
  double source, opposite, sides;  ///< exact B for E = 1 on the source  [W/m^2]
};

// From F(opposite) = .19982489569838746 and F(adjacent) = .20004377607540316.
constexpr CubeCase kCases[] = {
    {0.5f, 1.0909090981076954, 0.1817458261077885, 0.18183626894612898},
    {0.8f, 1.5517241536449147, 0.6895510707376377, 0.6896811939043618},
};

/// The source is the floor (-z).
SceneBuilder cube(float reflectance) {
  SceneBuilder built;
  const engine::Rgb rho{reflectance, reflectance, reflectance};
  const auto wall = built.add_material(rho), source = built.add_material(rho, {1, 1, 1});
  built.add_box({0, 0, 0}, {1, 1, 1}, true, {wall, wall, wall, wall, source, wall});
  return built;
}

constexpr std::uint64_t kSeeds = 48;

/// One false alarm in 10,000 choices of seeds: 2 reflectances x 2 ways of the first light x 3 answers.
constexpr double kFalseAlarm = 1e-4 / 12;

void expect_exact(const CubeCase& exact, api::DirectLight direct) {
  const ReadyScene ready(cube(exact.reflectance), 2.0);
  ASSERT_EQ(ready.patches.count(), 6u);
  api::LightingOptions options;
  options.direct = direct;
  options.line_count = 262'144;
  options.samples_per_light = 256;
  Sample source, opposite, sides;
  for (options.seed = 1; options.seed <= kSeeds; ++options.seed) {
    const LitFrames lit = light_frames(ready, {0}, options);
    source.add(lit.radiosity.at(4, 0).r);
    opposite.add(lit.radiosity.at(5, 0).r);
    sides.add(mean_over(ready, lit.radiosity, {0, 1, 2, 3}, 0).r);
  }
  // The iteration stops within 1e-5 rho / (1 - rho) of the mean source, which is 1/6 at most; single
  // precision adds 1e-7 per operation.
  const double iteration = 1e-5 * exact.reflectance / (1 - exact.reflectance) / 6 + 1e-6;
  EXPECT_TRUE(agrees(source, exact.source, kFalseAlarm, iteration));
  EXPECT_TRUE(agrees(opposite, exact.opposite, kFalseAlarm, iteration));
  EXPECT_TRUE(agrees(sides, exact.sides, kFalseAlarm, iteration));
  // The form factors of opposite and adjacent faces differ by .11 %: only then is the test sharp.
  EXPECT_LT(opposite.standard_error(), 3e-4 * exact.opposite);
  EXPECT_LT(sides.standard_error(), 3e-4 * exact.sides);
}

/// The three unknowns for any reflectance: with F and A the form factors of opposite and adjacent faces
///
///     s = 1 + rho (F o + 4 A d),   o = rho (F s + 4 A d),   d = rho (A (s + o) + (F + 2 A) d)
///
/// so s - o = 1 / (1 + rho F), and s + o from the sum and d.
CubeCase exact_of(double rho) {
  const double opposite = .19982489569838746, adjacent = .20004377607540316;
  const double between = rho * adjacent / (1 - rho * (opposite + 2 * adjacent));  // d / (s + o)
  const double sum = 1 / (1 - rho * opposite - 8 * rho * adjacent * between);
  const double apart = 1 / (1 + rho * opposite);
  return {static_cast<float>(rho), (sum + apart) / 2, (sum - apart) / 2, between * sum};
}

}  // namespace

TEST(Cube, RadiosityIsExactWhenDirectLightIsApart) {
  for (const CubeCase& exact : kCases) expect_exact(exact, api::DirectLight::apart);
}

TEST(Cube, RadiosityIsExactWhenAllLightTravelsByLines) {
  for (const CubeCase& exact : kCases) expect_exact(exact, api::DirectLight::pure);
}

// Its walls are painted while it is looked at: from .5 to .8 over five frames, the lines as many as for one
// paint, and each frame with the answer of its own.
TEST(Cube, RadiosityIsExactInEveryFrameOfAReflectanceThatIsKeyed) {
  EXPECT_NEAR(exact_of(0.5).sides, kCases[0].sides, 1e-12);
  EXPECT_NEAR(exact_of(0.8).source, kCases[1].source, 1e-12);
  constexpr engine::FrameIndex kFrames = 5;
  const SceneBuilder built = cube(0.5f);
  engine::Animation painted = built.animation();
  painted.frame_count = kFrames;
  painted.objects[0].spans = {{0, kFrames - 1, {}}};
  painted.reflectance.resize(built.scene().materials.size());
  for (engine::FrameIndex f = 0; f < kFrames; ++f)
    for (auto& series : painted.reflectance) {
      const float rho = 0.5f + 0.075f * static_cast<float>(f);
      series.push_back({rho, rho, rho});
    }
  const ReadyScene ready(built.scene(), painted, 2.0), plain(built, 2.0);
  api::LightingOptions options;
  options.line_count = 131'072;
  options.samples_per_light = 256;
  EXPECT_EQ(light_frames(ready, every_frame(painted), options).counts.tracing.lines,
            light_frames(plain, {0}, options).counts.tracing.lines);
  std::array<Sample, kFrames> source, opposite, sides;
  for (options.seed = 1; options.seed <= 24; ++options.seed) {
    const LitFrames lit = light_frames(ready, every_frame(painted), options);
    for (engine::FrameIndex f = 0; f < kFrames; ++f) {
      source[f].add(lit.radiosity.at(4, f).r);
      opposite[f].add(lit.radiosity.at(5, f).r);
      sides[f].add(mean_over(ready, lit.radiosity, {0, 1, 2, 3}, f).r);
    }
  }
  constexpr double kOfEach = 1e-4 / (3 * kFrames);
  for (engine::FrameIndex f = 0; f < kFrames; ++f) {
    const CubeCase exact = exact_of(0.5f + 0.075f * static_cast<float>(f));
    const double iteration = 1e-5 * exact.reflectance / (1 - exact.reflectance) / 6 + 1e-6;
    EXPECT_TRUE(agrees(source[f], exact.source, kOfEach, iteration)) << f;
    EXPECT_TRUE(agrees(opposite[f], exact.opposite, kOfEach, iteration)) << f;
    EXPECT_TRUE(agrees(sides[f], exact.sides, kOfEach, iteration)) << f;
    EXPECT_LT(opposite[f].standard_error(), 1e-3 * exact.opposite);
  }
}

}  // namespace tests
