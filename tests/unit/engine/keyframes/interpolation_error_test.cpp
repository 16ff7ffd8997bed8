#include "engine/keyframes/interpolation_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using tests::series;
using tests::Squares;

// B = 2 everywhere but 3 in frame 1 of patch 0: |B^ - B| = 1 over B = 3; half the mean (about 1) is less.
TEST(InterpolationError, IsRelativeToTheRadiosityOfPatchAndFrame) {
  const Squares world(2, 5);
  const auto radiosity = series(2, 5, [](auto p, auto f) { return p == 0 && f == 1 ? 3.0f : 2.0f; });
  const InterpolationError error(world.lit(), radiosity, radiosity);
  EXPECT_NEAR(error.at(0, 1, 4), 1.0 / 3, 1e-6);
  EXPECT_NEAR(error.at(0, 2, 4), 0, 1e-6);
  EXPECT_NEAR(error.at(1, 2, 4), (2.0 / 3) / 2, 1e-6);  // between 3 and 2, a third of the way
  EXPECT_NEAR(error.largest(0, 4), 1.0 / 3, 1e-6);
  EXPECT_EQ(error.largest(2, 3), 0);
}

// Mean B = (4 + 0) / 2 = 2: a dark patch is measured against 1.
TEST(InterpolationError, OfADarkPatchIsRelativeToHalfTheMean) {
  const Squares world(2, 3);
  const auto radiosity = series(2, 3, [](auto p, auto) { return p == 0 ? 4.0f : 0.0f; });
  const auto interpolated = series(2, 3, [](auto p, auto f) { return p == 1 && f == 1 ? 0.25f : 0.0f; });
  const InterpolationError error(world.lit(), radiosity, interpolated);
  EXPECT_NEAR(error.at(0, 1, 2), 0.25, 1e-6);
}

TEST(InterpolationError, TheLargestChannelCounts) {
  const Squares world(1, 3);
  PatchSeries radiosity(1, 3);
  for (FrameIndex f = 0; f < 3; ++f) radiosity.at(0, f) = {1, 0.1f, 2};
  PatchSeries interpolated(1, 3);
  interpolated.at(0, 1) = {0.1f, -0.5f, 0.2f};
  const InterpolationError error(world.lit(), radiosity, interpolated);
  EXPECT_NEAR(error.at(0, 1, 2), 0.25, 1e-6);
}

// A light of B = 1000 must not hide what happens on the walls.
TEST(InterpolationError, PatchesThatEmitDoNotCountInTheMean) {
  Scene scene = tests::squares(2);
  scene.materials.push_back(scene.materials[0]);
  scene.polygons[0].material = 1;
  Animation animation = tests::still(scene, 3);
  animation.emission.exitance_w_m2[1] = {{}, {1000, 0, 0}, {}};
  const tests::World world(scene, animation, 1.0);
  const auto radiosity = series(2, 3, [](auto p, auto) { return p == 0 ? 1000.0f : 2.0f; });
  const auto interpolated = series(2, 3, [](auto p, auto f) { return p == 1 && f == 1 ? 1.0f : 0.0f; });
  const InterpolationError error(world.lit(), radiosity, interpolated);
  EXPECT_NEAR(error.at(0, 1, 2), 0.5, 1e-6);
}

TEST(InterpolationError, LeftOutTakesTheWeightOfTheLaterFrame) {
  const Squares world(1, 3);
  const auto radiosity = series(1, 3, [](auto, auto f) { return f == 0 ? 1.0f : f == 1 ? 2.0f : 3.0f; });
  const InterpolationError error(world.lit(), radiosity, radiosity);
  EXPECT_NEAR(error.left_out(0, 1, 2, 0.5f), 0, 1e-6);
  EXPECT_NEAR(error.left_out(0, 1, 2, 0.75f), 0.25, 1e-6);
}

TEST(InterpolationError, WithinIsLargestAgainstTheTolerance) {
  const Squares world(5, 30);
  const auto wavy = series(5, 30, [](auto p, auto f) {
    return 2 + std::sin(0.3f * static_cast<float>(f) * static_cast<float>(p + 1));
  });
  InterpolationError error(world.lit(), wavy, wavy);
  for (FrameIndex a = 0; a < 29; ++a)
    for (FrameIndex b = a + 1; b < 30; ++b)
      for (const double tolerance : {0.01, 0.1, 0.5})
        ASSERT_EQ(error.within(a, b, tolerance), error.largest(a, b) <= tolerance) << a << " " << b;
}

// In the middle of two frames the difference has sqrt(1 + 1/4 + 1/4) standard errors of one frame.
TEST(InterpolationError, FourStandardErrorsOfTheDifferenceAreTakenOff) {
  const Squares world(1, 3);
  const auto radiosity = series(1, 3, [](auto, auto f) { return f == 1 ? 2.0f : 1.0f; });
  const float sigma = 0.1f, taken = 4 * std::sqrt(1.5f) * sigma;
  EXPECT_NEAR(InterpolationError(world.lit(), radiosity, radiosity, {sigma}).at(0, 1, 2), (1 - taken) / 2,
              1e-6);
  EXPECT_EQ(InterpolationError(world.lit(), radiosity, radiosity, {1.0f}).at(0, 1, 2), 0);
}

TEST(InterpolationError, ASceneWithoutLightHasNone) {
  const Squares world(1, 3);
  const PatchSeries dark(1, 3);
  EXPECT_EQ(InterpolationError(world.lit(), dark, dark).at(0, 1, 2), 0);
}

}  // namespace
}  // namespace engine
