// Lights without a surface, over time.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/animation/animation.h"

namespace engine {
namespace {

api::JobRequest ten_frames() {
  api::JobRequest request;
  request.frame_count = 10;
  return request;
}

api::LightSource light_of(api::LightType type, api::Vec3 position, api::Vec3 direction, api::Vec3 intensity) {
  api::LightSource light;
  light.type = type;
  if (type != api::LightType::directional) light.position.keys = {{0, position}};
  if (type != api::LightType::point) light.direction.keys = {{0, direction}};
  light.intensity.keys = {{0, intensity}};
  return light;
}

std::vector<SourceMotion> sources_of(const api::JobRequest& request) {
  return animate(Scene{}, request).emission.sources;
}

float distance(Vec3 a, Vec3 b) {
  return length(a - b);
}
constexpr float kRounding = 1e-6f;

TEST(Sources, ThatNeverChangeHaveOneValueOfEach) {
  api::JobRequest request = ten_frames();
  request.scene.metres_per_unit = 0.01;
  request.scene.lights["sun"] = light_of(api::LightType::directional, {}, {0, -3, 4}, {90, 80, 70});
  request.scene.lights["bulb"] = light_of(api::LightType::point, {100, 200, 300}, {}, {3, 2, 1});
  request.scene.lights["spot"] = light_of(api::LightType::spot, {0, 100, 0}, {0, -1e-9, 0}, {5, 5, 5});
  request.scene.lights["spot"].inner_degrees = 0;
  request.scene.lights["spot"].outer_degrees = 60;
  const auto sources = sources_of(request);
  ASSERT_EQ(sources.size(), 3u);
  for (const SourceMotion& source : sources) {
    EXPECT_TRUE(source.is_static()) << source.name;
    EXPECT_EQ(source.intensity.size(), 1u) << source.name;
    EXPECT_FLOAT_EQ(length(source.direction[0]), 1) << source.name;
  }
  EXPECT_EQ(sources[0].name, "bulb");
  EXPECT_EQ(sources[0].position[0], (Vec3{1, 2, 3})) << "metres";
  EXPECT_EQ(sources[0].intensity[0], (Rgb{3, 2, 1}));
  EXPECT_EQ(sources[1].type, api::LightType::spot);
  EXPECT_EQ(sources[1].direction[0], (Vec3{0, -1, 0}));
  EXPECT_DOUBLE_EQ(sources[1].inner_cosine, 1);
  EXPECT_NEAR(sources[1].outer_cosine, 0.5, 1e-15);
  EXPECT_LT(distance(sources[2].direction[0], {0, -.6f, .8f}), kRounding);
}

TEST(Sources, FollowTheirTracks) {
  api::JobRequest request = ten_frames();
  api::LightSource light = light_of(api::LightType::spot, {0, 0, 0}, {1, 0, 0}, {0, 0, 0});
  light.position.keys.push_back({9, {9, 18, 0}});
  light.direction.keys.push_back({8, {0, 50, 0}});  // a longer key weighs no more
  light.intensity.keys.push_back({4, {8, 4, 2}});
  request.scene.lights["torch"] = light;
  const SourceMotion torch = sources_of(request).at(0);
  ASSERT_EQ(torch.position.size(), 10u);
  EXPECT_EQ(torch.position[3], (Vec3{3, 6, 0}));
  EXPECT_LT(distance(torch.direction[4], {std::sqrt(.5f), std::sqrt(.5f), 0}), kRounding);
  EXPECT_EQ(torch.intensity[1], (Rgb{2, 1, .5f}));
  EXPECT_EQ(torch.intensity[9], (Rgb{8, 4, 2}));
  EXPECT_TRUE(torch.ever_emits());
}

TEST(Sources, NeverHaveANegativeIntensity) {
  api::JobRequest request = ten_frames();
  request.scene.lights["lamp"] = light_of(api::LightType::point, {}, {}, {9, 9, 9});
  request.scene.lights["lamp"].intensity = {api::KeyInterpolation::cubic,
                                            {{0, {9, 9, 9}}, {3, {0, 0, 0}}, {6, {0, 0, 0}}, {9, {9, 9, 9}}}};
  const SourceMotion lamp = sources_of(request).at(0);
  for (const Rgb i : lamp.intensity) EXPECT_GE(i.g, 0);
  EXPECT_EQ(lamp.intensity[4], Rgb{});
}

TEST(Sources, WhoseDirectionVanishesKeepThatOfTheFrameBefore) {
  api::JobRequest request = ten_frames();
  request.scene.lights["spot"] = light_of(api::LightType::spot, {}, {.1, .3, 0}, {1, 1, 1});
  request.scene.lights["spot"].direction.keys.push_back({8, {-.1, -.3, 0}});
  const SourceMotion spot = sources_of(request).at(0);
  ASSERT_EQ(spot.direction.size(), 10u);
  for (const Vec3 d : spot.direction) EXPECT_FLOAT_EQ(length(d), 1);
  EXPECT_EQ(spot.direction[4], spot.direction[3]);
  EXPECT_LT(distance(spot.direction[5], -spot.direction[3]), kRounding);
}

TEST(Sources, AreCarriedByTheirParentAndDarkWithoutIt) {
  api::JobRequest request = ten_frames();
  request.scene.metres_per_unit = 0.5;
  api::ObjectAnimation& car = request.scene.objects["car"];
  car.parent = "ship";
  car.rotate.track.keys = {{0, {0, 90, 0, 0}}};  // +z becomes +x
  car.scale.keys = {{0, {2, 2, 2}}};
  car.visible.keys = {{0, false}, {2, true}, {7, false}};
  request.scene.objects["ship"].translate.keys = {{0, {0, 0, 0}}, {9, {0, 9, 0}}};
  request.scene.lights["headlight"] = light_of(api::LightType::spot, {0, 0, 1}, {0, 0, 1}, {6, 6, 6});
  request.scene.lights["headlight"].parent = "car";
  const SourceMotion light = sources_of(request).at(0);
  ASSERT_EQ(light.position.size(), 10u);
  EXPECT_LT(distance(light.position[4], {1, 2, 0}), kRounding);
  ASSERT_EQ(light.direction.size(), 1u) << "the ship does not turn";
  EXPECT_LT(distance(light.direction[0], {1, 0, 0}), kRounding);
  ASSERT_EQ(light.intensity.size(), 10u);
  EXPECT_EQ(light.intensity[1], Rgb{});
  EXPECT_EQ(light.intensity[2], (Rgb{6, 6, 6}));
  EXPECT_EQ(light.intensity[7], Rgb{});
  EXPECT_EQ(light.position[0], light.position[2]) << "where it is dark it need not move";
  EXPECT_EQ(light.position[9], light.position[6]);
}

TEST(Sources, WhoseParentIsNeverThereAreDark) {
  api::JobRequest request = ten_frames();
  request.scene.objects["car"].visible.keys = {{0, false}};
  request.scene.lights["headlight"] = light_of(api::LightType::spot, {0, 0, 1}, {0, 0, 1}, {6, 6, 6});
  request.scene.lights["headlight"].parent = "car";
  const SourceMotion light = sources_of(request).at(0);
  EXPECT_FALSE(light.ever_emits());
  EXPECT_TRUE(light.is_static());
  EXPECT_FLOAT_EQ(length(light.direction[0]), 1);
}

TEST(Sources, OfADirectionDoNotMoveWithTheTranslationOfTheirParent) {
  api::JobRequest request = ten_frames();
  request.scene.objects["ship"].translate.keys = {{0, {0, 0, 0}}, {9, {0, 9, 0}}};
  request.scene.lights["sun"] = light_of(api::LightType::directional, {}, {0, -1, 0}, {6, 6, 6});
  request.scene.lights["sun"].parent = "ship";
  EXPECT_TRUE(sources_of(request).at(0).is_static());
}

}  // namespace
}  // namespace engine
