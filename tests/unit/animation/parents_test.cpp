// Objects that others carry.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/animation/object_motion.h"

namespace engine {
namespace {

constexpr FrameIndex kFrames = 10;
constexpr double kRounding = 1e-12;

using Objects = std::map<std::string, api::ObjectAnimation>;

ObjectMotion motion_in(const Objects& objects, const std::string& name, double metres_per_unit = 1) {
  api::SceneDescription description;
  description.objects = objects;
  description.metres_per_unit = metres_per_unit;
  return motion_of(Placement(description, name), kFrames);
}

api::ObjectAnimation turning_about_y(double degrees_per_frame, api::Vec3 pivot) {
  api::ObjectAnimation object;
  object.pivot = pivot;
  object.rotate.track.keys = {{0, {0, 0, 0, 0}}, {9, {0, 9 * degrees_per_frame, 0, 0}}};
  return object;
}

const Pose& pose_in(const ObjectMotion& motion, FrameIndex frame) {
  for (const PoseSpan& span : motion.spans)
    if (span.first <= frame && frame <= span.last) return span.pose;
  throw std::out_of_range("not visible");
}

void expect_at(const Pose& pose, Vec3 p, std::array<double, 3> expected) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = pose.m[i];
    EXPECT_NEAR(row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3], expected[i], kRounding) << i;
  }
}

// A wheel at (2, 0, 0) of a car; the wheel turns about itself, then the car drives and turns by 90 degrees
// about the origin (+z becomes +x, +x becomes -z).
TEST(Parents, ArePlacedAfterTheObjectItself) {
  Objects objects;
  objects["wheel"] = turning_about_y(90, {2, 0, 0});
  objects["wheel"].parent = "car";
  objects["car"] = turning_about_y(90, {0, 0, 0});
  objects["car"].translate.keys = {{0, {0, 0, 0}}, {1, {0, 0, 100}}};
  const ObjectMotion wheel = motion_in(objects, "wheel", 0.5);  // in units: half of it in metres
  // Frame 1: (3, 0, 0) turns about the hub to (2, 0, -1), the car takes that to (-1, 0, -2) + (0, 0, 100).
  expect_at(pose_in(wheel, 1), {1.5f, 0, 0}, {-.5, 0, 49});
  expect_at(pose_in(wheel, 0), {1.5f, 0, 0}, {1.5, 0, 0});
}

TEST(Parents, CarryOverSeveralSteps) {
  Objects objects;
  objects["hand"].parent = "arm";
  objects["hand"].translate.keys = {{0, {1, 0, 0}}};
  objects["arm"].parent = "body";
  objects["arm"].scale.keys = {{0, {2, 2, 2}}};
  objects["body"].translate.keys = {{0, {0, 0, 0}}, {9, {0, 9, 0}}};
  const ObjectMotion hand = motion_in(objects, "hand");
  ASSERT_EQ(hand.spans.size(), kFrames);
  expect_at(hand.spans[4].pose, {0, 0, 1}, {2, 4, 2});
}

TEST(Parents, ThatRestLeaveAStillObjectStatic) {
  Objects objects;
  objects["lid"].parent = "box";
  objects["lid"].rotate.track.keys = {{0, {10, 20, 30, 0}}};
  objects["box"].rotate.track.keys = {{0, {3, 2, 1, 0}}};
  objects["box"].translate.keys = {{0, {.1, .2, .3}}, {9, {.1, .2, .3}}};
  EXPECT_TRUE(motion_in(objects, "lid", 0.3).is_static(kFrames));
  objects["box"].translate.keys[1].value[0] = .2;
  EXPECT_EQ(motion_in(objects, "lid", 0.3).spans.size(), kFrames);
}

TEST(Parents, HideWhatTheyCarry) {
  Objects objects;
  objects["wheel"].parent = "car";
  objects["wheel"].visible.keys = {{0, true}, {8, false}};
  objects["car"].visible.keys = {{0, false}, {3, true}};
  const ObjectMotion wheel = motion_in(objects, "wheel");
  ASSERT_EQ(wheel.spans.size(), 1u);
  EXPECT_EQ(wheel.spans[0].first, 3u);
  EXPECT_EQ(wheel.spans[0].last, 7u);
  EXPECT_EQ(motion_in(objects, "car").spans[0].last, 9u) << "a hidden wheel does not hide the car";
}

TEST(Parents, MayCarryTheRestOfTheScene) {
  Objects objects;
  objects[""].parent = "ship";
  objects["ship"].translate.keys = {{0, {0, 7, 0}}};
  expect_at(motion_in(objects, "").spans.at(0).pose, {0, 0, 0}, {0, 7, 0});
}

// A job like this is refused before it comes here; what counts is that this ends.
TEST(Parents, InACircleOrUnknownDoNotGoOnForEver) {
  Objects objects;
  objects["chicken"].parent = "egg";
  objects["egg"].parent = "chicken";
  objects["self"].parent = "self";
  objects["orphan"].parent = "gone";
  for (const auto& [name, object] : objects) EXPECT_TRUE(motion_in(objects, name).is_static(kFrames)) << name;
}

TEST(Parents, AreFollowedAsFarAsAJobMayGo) {
  Objects objects;
  for (std::size_t k = 0; k <= kParentsMax; ++k) {
    api::ObjectAnimation& object = objects[std::to_string(k)];
    object.translate.keys = {{0, {1, 0, 0}}};
    if (k > 0) object.parent = std::to_string(k - 1);
  }
  expect_at(motion_in(objects, std::to_string(kParentsMax)).spans.at(0).pose, {0, 0, 0},
            {1.0 + kParentsMax, 0, 0});
}

}  // namespace
}  // namespace engine
