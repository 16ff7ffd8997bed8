#include "engine/pipeline/check_poses.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

using Warnings = std::vector<std::string>;

/// A room that rests and a box of 10 cm named "a/b".
Scene room_and_box() {
  Scene scene = tests::scene_with(2, 1);
  scene.objects[1].name = "a/b";
  tests::add_box(scene, {0, 0, 0}, {4, 4, 3}, true);
  tests::add_box(scene, {1, 1, 1}, {1.1f, 1.1f, 1.1f}, false, 1);
  return scene;
}

/// The box elsewhere from frame 5 of 10 on.
Animation box_at(const Scene& scene, const Pose& pose) {
  Animation animation = tests::still(scene, 10);
  animation.objects[1].spans = {{0, 4, {}}, {5, 9, pose}};
  return animation;
}

Pose scaled(double factor) {
  Pose pose;
  for (int k = 0; k < 3; ++k) pose.m[k][k] = factor;
  return pose;
}

std::string refused_at(const Scene& scene, const Animation& animation) {
  Warnings warnings;
  const auto status = check_poses(scene, animation, warnings);
  if (status) return "accepted";
  EXPECT_EQ(status.error().fault, api::Fault::invalid_request);
  EXPECT_FALSE(status.error().violations.empty());
  const api::Violation& violation = status.error().violations.at(0);
  EXPECT_EQ(violation.file, "animation.json");
  EXPECT_EQ(violation.code, "out_of_range");
  return violation.pointer + ": " + violation.detail;
}

Warnings warnings_of(const Scene& scene, const Animation& animation) {
  Warnings warnings;
  EXPECT_TRUE(check_poses(scene, animation, warnings));
  return warnings;
}

TEST(CheckPoses, WhatMovesWithinItsRoomIsFine) {
  const Scene scene = room_and_box();
  EXPECT_EQ(warnings_of(scene, box_at(scene, tests::moved_to(1, 2, 0.5))), Warnings{});
}

TEST(CheckPoses, AnObjectThatGoesTooFarIsNamedWithItsFirstFrameThere) {
  const Scene scene = room_and_box();
  EXPECT_EQ(refused_at(scene, box_at(scene, tests::moved_to(0, -1.1e7, 0))),
            "/objects/a~1b: 'a/b' is more than 1e+07 m from the origin in frame 5");
  EXPECT_EQ(refused_at(scene, box_at(scene, tests::moved_to(0, -0.9e7, 0))), "accepted");
}

TEST(CheckPoses, ScaleCountsAsWellAsTranslation) {
  const Scene scene = room_and_box();
  EXPECT_EQ(refused_at(scene, box_at(scene, scaled(1e7))).substr(0, 13), "/objects/a~1b");
}

TEST(CheckPoses, WhatIsNoNumberIsRefused) {
  const Scene scene = room_and_box();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused_at(scene, box_at(scene, tests::moved_to(infinity, 0, 0))).substr(0, 13), "/objects/a~1b");
  Pose pose = scaled(infinity);
  pose.m[0][3] = -infinity;
  EXPECT_EQ(refused_at(scene, box_at(scene, pose)).substr(0, 13), "/objects/a~1b");
}

TEST(CheckPoses, ACameraThatGoesTooFarIsNamed) {
  const Scene scene = room_and_box();
  Animation animation = tests::still(scene, 2);
  animation.cameras["drone"] = {{{0, 0, 1}, {1, 0, 1}, {0, 1, 0}, 50},
                                {{0, 0, 1}, {1, 0, 2e7f}, {0, 1, 0}, 50}};
  EXPECT_EQ(refused_at(scene, animation),
            "/cameras/drone: 'drone' is more than 1e+07 m from the origin in frame 1");
}

TEST(CheckPoses, AnObjectWithoutPolygonsMayBeAnywhere) {
  Scene scene = room_and_box();
  scene.objects.push_back({"empty"});
  Animation animation = tests::still(scene, 10);
  animation.objects[2].spans = {{0, 9, tests::moved_to(1e300, 0, 0)}};
  EXPECT_EQ(warnings_of(scene, animation), Warnings{});
}

TEST(CheckPoses, ALightThatGoesTooFarIsNamedWithItsFirstFrameThere) {
  const Scene scene = room_and_box();
  Animation animation = tests::still(scene, 10);
  SourceMotion torch{"a/torch", api::LightType::point, std::vector<Vec3>(10), {{0, 0, 1}}, {{1, 1, 1}}};
  for (std::size_t f = 0; f < 10; ++f) torch.position[f] = {2, 2, f < 7 ? 2.f : -1.1e7f};
  animation.emission.sources = {torch};
  EXPECT_EQ(refused_at(scene, animation),
            "/lights/a~1torch: 'a/torch' is more than 1e+07 m from the origin in frame 7");
  animation.emission.sources[0].position[7] = {2, std::numeric_limits<float>::quiet_NaN(), 2};
  EXPECT_NE(refused_at(scene, animation).find("in frame 7"), std::string::npos);
  animation.emission.sources[0].position = {{2, 2, 2}};
  EXPECT_EQ(refused_at(scene, animation), "accepted");
}

// Each of them stays near; together they do not.
TEST(CheckPoses, AnObjectCarriedTooFarByItsParentIsNamed) {
  const Scene scene = room_and_box();
  api::JobRequest request;
  request.frame_count = 10;
  api::ObjectAnimation& box = request.scene.objects["a/b"];
  box.parent = "cart";
  box.translate.keys = {{0, {6e6, 0, 0}}};
  request.scene.objects["cart"].translate.keys = {{0, {0, 0, 0}}, {9, {9e6, 0, 0}}};
  EXPECT_EQ(refused_at(scene, animate(scene, request)),
            "/objects/a~1b: 'a/b' is more than 1e+07 m from the origin in frame 4");
  request.scene.objects["cart"].translate.keys[1].value[0] = 3e6;
  EXPECT_EQ(refused_at(scene, animate(scene, request)), "accepted");
}

TEST(CheckPoses, AThousandRoomsBetweenWhatMovesAndWhatRestsIsWarnedAbout) {
  Scene scene = tests::scene_with(2, 1);
  tests::add_box(scene, {0, 0, 0}, {4, 4, 3}, true);
  tests::add_box(scene, {0, 0, 0}, {4, 4, 3}, false, 1);  // of the same size: rounding is no matter
  EXPECT_EQ(warnings_of(scene, box_at(scene, tests::moved_to(5000, 0, 0))), Warnings{});
  const Warnings warnings = warnings_of(scene, box_at(scene, tests::moved_to(8000, 0, 0)));  // diagonal 6.4
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("few lines"), std::string::npos) << warnings[0];
}

// Above 2^10 m a float steps by 2^-13 m = 0.12 mm: 1.2 thousandths of 10 cm.
TEST(CheckPoses, CoordinatesTooLargeForTheirEdgesAreWarnedAbout) {
  Scene scene = tests::scene_with(1, 1);
  scene.objects[0].name = "statue";
  const auto at = [&](float x) {
    scene.vertices.clear(), scene.corners.clear(), scene.polygons.clear();
    tests::add_box(scene, {x, 0, 0}, {x + 0.1f, 0.1f, 0.1f}, false);
    return warnings_of(scene, tests::still(scene, 1));
  };
  EXPECT_EQ(at(1000), Warnings{});
  const Warnings warnings = at(1030);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("'statue'"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("nearer to the origin"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace engine
