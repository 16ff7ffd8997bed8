// Whole animations: objects, lights and cameras by name.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/animation/animation.h"

namespace engine {
namespace {

using api::KeyInterpolation;

Scene two_objects_two_materials() {
  Scene scene;
  scene.objects = {{""}, {"plane"}};
  scene.materials = {{"wall", {.5f, .5f, .5f}, {}, true}, {"lamp", {.5f, .5f, .5f}, {1, 2, 3}, true}};
  return scene;
}

api::JobRequest ten_frames() {
  api::JobRequest request;
  request.frame_count = 10;
  return request;
}

TEST(Animate, LeavesStillWhatNothingMoves) {
  const Animation animation = animate(two_objects_two_materials(), ten_frames());
  EXPECT_EQ(animation.frame_count, 10u);
  ASSERT_EQ(animation.objects.size(), 2u);
  for (const ObjectMotion& motion : animation.objects) {
    EXPECT_TRUE(motion.is_static(10));
    EXPECT_EQ(motion.spans[0].pose, Pose{});
  }
  ASSERT_EQ(animation.emission.exitance_w_m2.size(), 2u);
  EXPECT_EQ(animation.emission.exitance_w_m2[1].size(), 1u);
  EXPECT_EQ(animation.emission.exitance(1, 7), (Rgb{1, 2, 3}));
}

TEST(Animate, MovesTheObjectOfTheNameAndNoOther) {
  api::JobRequest request = ten_frames();
  request.scene.metres_per_unit = 0.5;
  request.scene.objects["plane"].translate.keys = {{0, {0, 0, 0}}, {9, {18, 0, 0}}};
  const Animation animation = animate(two_objects_two_materials(), request);
  EXPECT_TRUE(animation.objects[0].is_static(10));
  ASSERT_EQ(animation.objects[1].spans.size(), 10u);
  EXPECT_DOUBLE_EQ(animation.objects[1].spans[3].pose.m[0][3], 3);
}

TEST(Animate, MovesTheRestOfTheSceneByTheEmptyName) {
  api::JobRequest request = ten_frames();
  request.scene.objects[""].translate.keys = {{0, {0, 4, 0}}};
  const Animation animation = animate(two_objects_two_materials(), request);
  EXPECT_EQ(animation.objects[0].spans[0].pose.m[1][3], 4);
  EXPECT_EQ(animation.objects[1].spans[0].pose, Pose{});
}

TEST(Animate, EvaluatesKeyedExitanceInEveryFrame) {
  api::JobRequest request = ten_frames();
  request.scene.materials["lamp"].exitance_w_m2.keys = {{0, {0, 0, 0}}, {8, {8, 4, 2}}};
  const Animation animation = animate(two_objects_two_materials(), request);
  ASSERT_EQ(animation.emission.exitance_w_m2[1].size(), 10u);
  EXPECT_EQ(animation.emission.exitance(1, 4), (Rgb{4, 2, 1}));
  EXPECT_EQ(animation.emission.exitance(1, 9), (Rgb{8, 4, 2}));
  EXPECT_EQ(animation.emission.exitance_w_m2[0].size(), 1u);
}

TEST(Animate, KeepsOneValueOfExitanceThatNeverChanges) {
  api::JobRequest request = ten_frames();
  request.scene.materials["lamp"].exitance_w_m2.keys = {{2, {5, 5, 5}}, {6, {5, 5, 5}}};
  const Animation animation = animate(two_objects_two_materials(), request);
  ASSERT_EQ(animation.emission.exitance_w_m2[1].size(), 1u);
  EXPECT_EQ(animation.emission.exitance(1, 9), (Rgb{5, 5, 5}));
}

TEST(Animate, NeverLetsACubicLightGoNegative) {
  api::JobRequest request = ten_frames();
  request.scene.materials["lamp"].exitance_w_m2 = {
      KeyInterpolation::cubic, {{0, {9, 9, 9}}, {3, {0, 0, 0}}, {6, {0, 0, 0}}, {9, {9, 9, 9}}}};
  const Animation animation = animate(two_objects_two_materials(), request);
  for (FrameIndex frame = 0; frame < 10; ++frame) EXPECT_GE(animation.emission.exitance(1, frame).r, 0);
  EXPECT_EQ(animation.emission.exitance(1, 4).r, 0);
}

TEST(Animate, LeavesReflectanceToTheMaterialWhereNothingKeysIt) {
  const Animation animation = animate(two_objects_two_materials(), ten_frames());
  ASSERT_EQ(animation.reflectance.size(), 2u);
  EXPECT_TRUE(animation.reflectance[0].empty() && animation.reflectance[1].empty());
  EXPECT_EQ(material_reflectance(two_objects_two_materials(), animation, 1, 3), (Rgb{.5f, .5f, .5f}));
}

TEST(Animate, EvaluatesKeyedReflectanceInEveryFrame) {
  api::JobRequest request = ten_frames();
  request.scene.materials["wall"].reflectance.keys = {{1, {0, .2, .4}}, {5, {.8, .6, .4}}};
  request.scene.materials["lamp"].reflectance.keys = {{0, {.25, .5, .75}}, {7, {.25, .5, .75}}};
  const Scene scene = two_objects_two_materials();
  const Animation animation = animate(scene, request);
  ASSERT_EQ(animation.reflectance[0].size(), 10u);
  EXPECT_EQ(material_reflectance(scene, animation, 0, 0), (Rgb{0, .2f, .4f}));
  EXPECT_EQ(material_reflectance(scene, animation, 0, 3), (Rgb{.4f, .4f, .4f}));
  EXPECT_EQ(material_reflectance(scene, animation, 0, 9), (Rgb{.8f, .6f, .4f}));
  EXPECT_EQ(animation.reflectance[1], (std::vector<Rgb>{{.25f, .5f, .75f}})) << "one value: never changes";
}

TEST(Animate, NeverLetsACubicReflectanceLeaveItsRange) {
  api::JobRequest request = ten_frames();
  const double most = 0.9999999;  // rounds to below 1, but is more than a material may have
  request.scene.materials["wall"].reflectance = {
      KeyInterpolation::cubic,
      {{0, {0, most, 0}}, {3, {most, 0, most}}, {6, {most, 0, most}}, {9, {0, most, 0}}}};
  const auto series = animate(two_objects_two_materials(), request).reflectance[0];
  ASSERT_EQ(series.size(), 10u);
  for (const Rgb rho : series)
    for (const float channel : {rho.r, rho.g, rho.b}) {
      EXPECT_GE(channel, 0);
      EXPECT_LE(channel, kReflectanceMax);
    }
  EXPECT_EQ(series[4], (Rgb{kReflectanceMax, 0, kReflectanceMax})) << "it overshoots both ways";
}

api::JobRequest with_camera(api::Vec3 position, api::Vec3 target, api::UpAxis up) {
  api::JobRequest request = ten_frames();
  request.scene.up = up;
  request.scene.cameras["main"].position.keys = {{0, position}};
  request.scene.cameras["main"].target.keys = {{0, target}};
  request.scene.cameras["main"].vertical_fov_degrees.keys = {{0, 40}, {4, 60}};
  return request;
}

std::vector<CameraPose> camera_of(const api::JobRequest& request) {
  return animate(two_objects_two_materials(), request).cameras.at("main");
}

/// What a renderer builds from a pose; not finite where position, target and up do not span a picture.
bool spans_a_picture(const CameraPose& pose) {
  const Vec3 view = normalized(pose.target - pose.position);
  const Vec3 right = normalized(cross(view, pose.up));
  return std::isfinite(right.x) && std::isfinite(right.y) && std::isfinite(right.z) &&
         length(cross(view, pose.up)) > 1e-3f;
}

TEST(Cameras, ArePlacedInMetres) {
  api::JobRequest request = with_camera({10, 0, 20}, {0, 30, 0}, api::UpAxis::y);
  request.scene.metres_per_unit = 0.1;
  const auto poses = camera_of(request);
  ASSERT_EQ(poses.size(), 10u);
  EXPECT_EQ(poses[0].position, (Vec3{1, 0, 2}));
  EXPECT_EQ(poses[0].target, (Vec3{0, 3, 0}));
  EXPECT_EQ(poses[0].up, (Vec3{0, 1, 0}));
  EXPECT_DOUBLE_EQ(poses[1].vertical_fov_degrees, 45);
}

TEST(Cameras, HaveTheJobsUpAxis) {
  EXPECT_EQ(camera_of(with_camera({1, 1, 1}, {0, 0, 0}, api::UpAxis::z))[0].up, (Vec3{0, 0, 1}));
}

TEST(Cameras, ThatLookAlongUpHaveAnotherUp) {
  for (const double height : {5.0, -5.0}) {
    const auto y_up = camera_of(with_camera({1, height, 1}, {1, 0, 1}, api::UpAxis::y));
    EXPECT_EQ(y_up[0].up, (Vec3{0, 0, -1}));
    EXPECT_TRUE(spans_a_picture(y_up[0]));
    const auto z_up = camera_of(with_camera({1, 1, height}, {1, 1, 0}, api::UpAxis::z));
    EXPECT_EQ(z_up[0].up, (Vec3{0, 1, 0}));
    EXPECT_TRUE(spans_a_picture(z_up[0]));
  }
}

TEST(Cameras, ThatPassThroughTheirTargetLookOn) {
  api::JobRequest request = with_camera({0, 0, 0}, {0, 0, 0}, api::UpAxis::y);
  request.scene.cameras["main"].position.keys = {{0, {-4, 1, 0}}, {8, {4, 1, 0}}};
  request.scene.cameras["main"].target.keys = {{0, {0, 1, 0}}};
  const auto poses = camera_of(request);
  for (const CameraPose& pose : poses) EXPECT_TRUE(spans_a_picture(pose));
  EXPECT_GT(poses[4].target.x, poses[4].position.x) << "still looks towards +x, as in frame 3";
  EXPECT_LT(poses[5].target.x, poses[5].position.x);
}

TEST(Cameras, ThatStandOnTheirTargetFromTheStartLookAhead) {
  const auto y_up = camera_of(with_camera({2, 2, 2}, {2, 2, 2}, api::UpAxis::y));
  EXPECT_LT(y_up[0].target.z, y_up[0].position.z);
  EXPECT_TRUE(spans_a_picture(y_up[0]));
  const auto z_up = camera_of(with_camera({2, 2, 2}, {2, 2, 2}, api::UpAxis::z));
  EXPECT_GT(z_up[0].target.y, z_up[0].position.y);
}

TEST(Cameras, KeepACubicFieldOfViewWithinItsRange) {
  api::JobRequest request = with_camera({1, 1, 1}, {0, 0, 0}, api::UpAxis::y);
  request.scene.cameras["main"].vertical_fov_degrees = {KeyInterpolation::cubic,
                                                        {{0, 100}, {3, 1}, {6, 1}, {9, 100}}};
  for (const CameraPose& pose : camera_of(request)) {
    EXPECT_GE(pose.vertical_fov_degrees, 1);
    EXPECT_LE(pose.vertical_fov_degrees, 170);
  }
}

}  // namespace
}  // namespace engine
