// Lights without surface against closed forms.
#include <cmath>
#include <numbers>

#include "tests/unit/engine/direct/lighting_runs.h"

namespace engine {
namespace {

using tests::add_level;
using tests::agrees;
using tests::light_directly;
using tests::Sample;
using tests::World;

constexpr Rgb kIntensity{10, 4, 1};
constexpr int kSeeds = 64;
constexpr double kFalseAlarm = 1e-6;  // per comparison
constexpr float kHalf = 0.5f;

SourceMotion source_at(api::LightType type, Vec3 position, Vec3 direction = {0, 0, -1}) {
  SourceMotion source;
  source.type = type;
  source.position = {position};
  source.direction = {direction};
  source.intensity = {kIntensity};
  return source;
}

SourceMotion spot_at(Vec3 position, Vec3 direction, double inner_degrees, double outer_degrees) {
  SourceMotion spot = source_at(api::LightType::spot, position, direction);
  spot.inner_cosine = std::cos(inner_degrees * std::numbers::pi / 180);
  spot.outer_cosine = std::cos(outer_degrees * std::numbers::pi / 180);
  return spot;
}

/// One floor patch of 1 m about (x, 0, 0) that looks up: patch 0. Objects 1 and 2 are there to be filled.
Scene floor_at(float x = 0) {
  Scene scene = tests::scene_with(3, 2);
  add_level(scene, {x, 0, 0}, kHalf, kHalf, false);
  return scene;
}

World lit_by(Scene scene, SourceMotion source, FrameIndex frames = 1) {
  Animation animation = tests::still(scene, frames);
  animation.emission.sources.push_back(std::move(source));
  return World(std::move(scene), std::move(animation), 10);
}

/// Mean of `f(x, y)` over the floor about (x0, 0) by the midpoint rule.
template <class F>
double mean_over_floor(double x0, const F& f) {
  constexpr int kSteps = 400;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) sum += f(x0 + (i + 0.5) / kSteps - 0.5, (j + 0.5) / kSteps - 0.5);
  return sum / (kSteps * kSteps);
}

Sample over_seeds(const World& world, PatchId patch = 0) {
  Sample sample;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
    sample.add(light_directly(world, {0}, {16, 1, seed}).irradiance_w_m2.at(patch, 0).r);
  return sample;
}

TEST(Sources, APointLightAboveAPlaneGivesIntensityTimesCosineOverSquaredDistance) {
  for (const double x0 : {0.0, 1.5}) {
    const World world =
        lit_by(floor_at(static_cast<float>(x0)), source_at(api::LightType::point, {0, 0, 0.8f}));
    const double expected = kIntensity.r * mean_over_floor(x0, [](double x, double y) {
                              return 0.8 / std::pow(x * x + y * y + 0.64, 1.5);
                            });
    EXPECT_TRUE(agrees(over_seeds(world), expected, kFalseAlarm)) << x0;
    const Rgb lit = light_directly(world, {0}).irradiance_w_m2.at(0, 0);
    EXPECT_FLOAT_EQ(lit.g, lit.r * 0.4f);
    EXPECT_FLOAT_EQ(lit.b, lit.r * 0.1f);
  }
}

// Whatever the shape of the room and the place of the light in it: all of 4 pi I arrives.
TEST(Sources, APointLightInAClosedRoomGivesItFourPiTimesItsIntensity) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_box(scene, {-1, -1.5f, 0}, {1, 1, 1.8f}, true);
  Animation animation = tests::still(scene, 1);
  animation.emission.sources.push_back(source_at(api::LightType::point, {0.3f, -0.2f, 1.2f}));
  const World world(scene, animation, 0.5);
  Sample flux;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const DirectLight lit = light_directly(world, {0}, {16, 1, seed});
    double sum = 0;
    for (PatchId patch = 0; patch < world.patches.count(); ++patch)
      sum += double{world.patches.area_m2[patch]} * lit.irradiance_w_m2.at(patch, 0).r;
    flux.add(sum);
  }
  EXPECT_TRUE(agrees(flux, 4 * std::numbers::pi * kIntensity.r, kFalseAlarm));
}

TEST(Sources, ASpotFallsOffSmoothlyBetweenItsConesAndIsDarkBeyond) {
  constexpr double kInner = 20, kOuter = 40, kHeight = 2;
  const auto share = [&](double cosine) {
    const double inner = std::cos(kInner * std::numbers::pi / 180),
                 outer = std::cos(kOuter * std::numbers::pi / 180);
    const double t = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  for (const double x0 : {0.0, 1.0, 1.5}) {  // inside, across the falloff, partly beyond it
    const World world = lit_by(floor_at(static_cast<float>(x0)),
                               spot_at({0, 0, static_cast<float>(kHeight)}, {0, 0, -1}, kInner, kOuter));
    const double expected = kIntensity.r * mean_over_floor(x0, [&](double x, double y) {
                              const double r = std::sqrt(x * x + y * y + kHeight * kHeight);
                              return share(kHeight / r) * kHeight / (r * r * r);
                            });
    EXPECT_GT(expected, 0);
    EXPECT_TRUE(agrees(over_seeds(world), expected, kFalseAlarm)) << x0;
  }
  // The outer cone ends at 2 tan 40 = 1.68 m.
  const World beyond = lit_by(floor_at(2.3f), spot_at({0, 0, 2}, {0, 0, -1}, kInner, kOuter));
  EXPECT_EQ(light_directly(beyond, {0}).irradiance_w_m2.at(0, 0), Rgb{});
}

TEST(Sources, ASpotWhoseConesAreOneHasAHardEdge) {
  const World inside = lit_by(floor_at(), spot_at({0, 0, 2}, {0, 0, -1}, 30, 30));
  const World as_point = lit_by(floor_at(), source_at(api::LightType::point, {0, 0, 2}));
  EXPECT_EQ(light_directly(inside, {0}).irradiance_w_m2.values,
            light_directly(as_point, {0}).irradiance_w_m2.values);
  const World outside = lit_by(floor_at(1.9f), spot_at({0, 0, 2}, {0, 0, -1}, 30, 30));
  EXPECT_EQ(light_directly(outside, {0}).irradiance_w_m2.at(0, 0), Rgb{});
}

TEST(Sources, ADirectionalLightGivesTheCosineWithoutNoise) {
  for (const double degrees : {0.0, 30.0, 75.0, 89.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 down{static_cast<float>(std::sin(angle)), 0, static_cast<float>(-std::cos(angle))};
    const World world = lit_by(floor_at(), source_at(api::LightType::directional, {}, down));
    const Rgb lit = light_directly(world, {0}).irradiance_w_m2.at(0, 0);
    EXPECT_NEAR(lit.r, kIntensity.r * std::cos(angle), 1e-5 * kIntensity.r) << degrees;
  }
  const World from_below = lit_by(floor_at(), source_at(api::LightType::directional, {}, {0, 0.6f, 0.8f}));
  EXPECT_EQ(light_directly(from_below, {0}).irradiance_w_m2.at(0, 0), Rgb{});
}

TEST(Sources, ADirectionalLightIsBlockedByWhateverIsInTheSceneHoweverFar) {
  Scene scene = floor_at();
  add_level(scene, {0, 0, 500}, 2, 2, true, 1);
  const World far = lit_by(scene, source_at(api::LightType::directional, {}, {0, 0, -1}));
  EXPECT_EQ(light_directly(far, {0}).irradiance_w_m2.at(0, 0), Rgb{});
  Animation comes = tests::still(scene, 2);  // the same card, far away only in the frame before
  comes.objects[1].spans = {{0, 0, tests::moved_to(0, 0, -505)}, {1, 1, tests::moved_to(0, 0, 3e4)}};
  comes.emission.sources.push_back(source_at(api::LightType::directional, {}, {0, 0, -1}));
  const DirectLight lit = light_directly(World(scene, comes, 10), {0, 1});
  EXPECT_GT(lit.irradiance_w_m2.at(0, 0).r, 0);
  EXPECT_EQ(lit.irradiance_w_m2.at(0, 1), Rgb{});
}

TEST(Sources, AMovingCardDarkensExactlyTheFramesInWhichItIsBetween) {
  for (const SourceMotion& source :
       {source_at(api::LightType::point, {0, 0, 2}), spot_at({0, 0, 2}, {0, 0, -1}, 40, 60),
        source_at(api::LightType::directional, {}, {0, 0, -1})}) {
    Scene scene = floor_at();
    const Rgb open = light_directly(lit_by(scene, source), {0}).irradiance_w_m2.at(0, 0);
    add_level(scene, {0, 0, 1}, 1, 1, true, 1);
    Animation animation = tests::still(scene, 6);
    animation.objects[1].spans = {{1, 1, {}},
                                  {2, 2, tests::moved_to(5, 0, 0)},
                                  {3, 4, tests::moved_to(0, 0, -0.5)}};  // not there in frames 0 and 5
    animation.emission.sources.push_back(source);
    const DirectLight lit = light_directly(World(scene, animation, 10), {0, 1, 2, 3, 4, 5});
    for (FrameIndex frame = 0; frame < 6; ++frame) {
      const bool between = frame == 1 || frame == 3 || frame == 4;
      EXPECT_EQ(lit.irradiance_w_m2.at(0, frame), between ? Rgb{} : open) << frame;
    }
    EXPECT_EQ(lit.at_rest_w_m2[0], open);
  }
}

TEST(Sources, ASourceThatMovesShinesInEachFrameAsFromThereAtRest) {
  const std::vector<Vec3> places{{0, 0, 1}, {0, 0, 1}, {1, 0, 1}, {0, 0, -1}};
  const std::vector<Vec3> directions{{0, 0, -1}, {0.6f, 0, -0.8f}, {-0.6f, 0, -0.8f}, {0, 0, -1}};
  const std::vector<Rgb> brightness{{1, 2, 3}, {4, 4, 4}, {0, 0, 5}, {1, 1, 1}};
  SourceMotion moving = spot_at({}, {}, 20, 70);
  moving.position = places;
  moving.direction = directions;
  moving.intensity = brightness;
  const DirectLight lit = light_directly(lit_by(floor_at(), moving, 4), {0, 1, 2, 3});
  for (FrameIndex frame = 0; frame < 4; ++frame) {
    SourceMotion resting = moving;
    resting.position = {places[frame]};
    resting.direction = {directions[frame]};
    resting.intensity = {brightness[frame]};
    const DirectLight alone = light_directly(lit_by(floor_at(), resting), {0});
    EXPECT_EQ(lit.irradiance_w_m2.at(0, frame), alone.irradiance_w_m2.at(0, 0)) << frame;
    EXPECT_EQ(alone.at_rest_w_m2[0], alone.irradiance_w_m2.at(0, 0));
  }
  EXPECT_GT(lit.irradiance_w_m2.at(0, 0).r, 0);
  EXPECT_NE(lit.irradiance_w_m2.at(0, 1), lit.irradiance_w_m2.at(0, 0) * 4.0f);  // turned
  EXPECT_EQ(lit.irradiance_w_m2.at(0, 3), Rgb{});                                // below the floor
  EXPECT_EQ(lit.at_rest_w_m2[0], Rgb{});
}

TEST(Sources, APointLightOnASurfaceIsNotHiddenByIt) {
  for (const float scale : {1e-3f, 1.0f, 1e3f}) {
    Scene scene = tests::scene_with(1, 1);
    add_level(scene, {0, 0, 0}, scale, scale, false);
    add_level(scene, {0, 0, 0.7f * scale}, scale, scale, true);  // a ceiling, with the light in its plane
    const World world = lit_by(scene, source_at(api::LightType::point, {0.1f * scale, 0, 0.7f * scale}));
    const DirectLight lit = light_directly(world, {0}, {64});
    Scene open = tests::scene_with(1, 1);
    add_level(open, {0, 0, 0}, scale, scale, false);
    const DirectLight without = light_directly(
        lit_by(open, source_at(api::LightType::point, {0.1f * scale, 0, 0.7f * scale})), {0}, {64});
    EXPECT_EQ(lit.irradiance_w_m2.at(0, 0), without.irradiance_w_m2.at(0, 0)) << scale;
  }
}

}  // namespace
}  // namespace engine
