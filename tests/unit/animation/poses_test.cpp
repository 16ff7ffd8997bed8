// Poses against matrices written out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/animation/object_motion.h"
#include "engine/animation/rotation.h"

namespace engine {
namespace {

using api::KeyInterpolation;
using api::RotationForm;

constexpr double kRounding = 1e-12;  // of products of a few cosines

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

ObjectMotion motion_of(const api::ObjectAnimation& object, double metres_per_unit, FrameIndex frame_count) {
  api::SceneDescription description;
  description.metres_per_unit = metres_per_unit;
  description.objects["it"] = object;
  return motion_of(Placement(description, "it"), frame_count);
}

/// The pose of a single frame of an object with constant tracks.
Pose pose_of(const api::ObjectAnimation& object, double metres_per_unit = 1) {
  const ObjectMotion motion = motion_of(object, metres_per_unit, 1);
  EXPECT_EQ(motion.spans.size(), 1u);
  return motion.spans[0].pose;
}

api::ObjectAnimation rotated(RotationForm form, std::array<double, 4> value, std::string order = "xyz") {
  api::ObjectAnimation object;
  object.rotate = {form, std::move(order), {KeyInterpolation::linear, {{0, value}}}};
  return object;
}

void expect_rotation(const Pose& pose, const Matrix3& expected, const std::string& what) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(pose.m[i][j], expected[i][j], kRounding) << what << " " << i << j;
}

// The closed forms of the six orders, for angles a about x, b about y, c about z; the order names what is
// applied first, so "xyz" is Rz Ry Rx. Source: any table of Tait-Bryan matrices.
TEST(EulerRotations, FollowTheirOrder) {
  const double a = radians(20), b = radians(-50), c = radians(110);
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b), cc = std::cos(c),
               sc = std::sin(c);
  const std::array<std::pair<std::string, Matrix3>, 6> closed_forms{{
      {"xyz",
       {{{cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa},
         {sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa},
         {-sb, cb * sa, cb * ca}}}},
      {"xzy",
       {{{cb * cc, sb * sa - cb * sc * ca, sb * ca + cb * sc * sa},
         {sc, cc * ca, -cc * sa},
         {-sb * cc, sb * sc * ca + cb * sa, cb * ca - sb * sc * sa}}}},
      {"yxz",
       {{{cc * cb - sc * sa * sb, -sc * ca, cc * sb + sc * sa * cb},
         {sc * cb + cc * sa * sb, cc * ca, sc * sb - cc * sa * cb},
         {-ca * sb, sa, ca * cb}}}},
      {"yzx",
       {{{cc * cb, -sc, cc * sb},
         {ca * sc * cb + sa * sb, ca * cc, ca * sc * sb - sa * cb},
         {sa * sc * cb - ca * sb, sa * cc, sa * sc * sb + ca * cb}}}},
      {"zxy",
       {{{cb * cc + sb * sa * sc, sb * sa * cc - cb * sc, sb * ca},
         {ca * sc, ca * cc, -sa},
         {cb * sa * sc - sb * cc, sb * sc + cb * sa * cc, cb * ca}}}},
      {"zyx",
       {{{cb * cc, -cb * sc, sb},
         {ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb},
         {sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb}}}},
  }};
  for (const auto& [order, expected] : closed_forms)
    expect_rotation(pose_of(rotated(RotationForm::euler_degrees, {20, -50, 110, 0}, order)), expected, order);
}

TEST(EulerRotations, ByQuarterTurnsAreExact) {
  const Pose pose = pose_of(rotated(RotationForm::euler_degrees, {0, 0, 90, 0}));
  EXPECT_EQ(pose.m[0][0], 0);
  EXPECT_EQ(pose.m[0][1], -1);
  EXPECT_EQ(pose.m[1][0], 1);
  EXPECT_EQ(pose_of(rotated(RotationForm::euler_degrees, {720, -360, 0, 0})), Pose{});
}

TEST(Rotations, ByAxisAngleEulerAndQuaternionAreTheSame) {
  const double half = radians(35);
  const Pose euler = pose_of(rotated(RotationForm::euler_degrees, {0, 70, 0, 0}));
  const Pose axis = pose_of(rotated(RotationForm::axis_angle_degrees, {0, 3, 0, 70}));
  const Pose quaternion =
      pose_of(rotated(RotationForm::quaternion, {0, 5 * std::sin(half), 0, 5 * std::cos(half)}));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(axis.m[i][j], euler.m[i][j], kRounding);
      EXPECT_NEAR(quaternion.m[i][j], euler.m[i][j], kRounding);
    }
}

// About (1,1,1) by 120 degrees, x becomes y, y becomes z, z becomes x.
TEST(Rotations, AboutTheDiagonalByAThirdExchangeTheAxes) {
  expect_rotation(pose_of(rotated(RotationForm::axis_angle_degrees, {1, 1, 1, 120})),
                  {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}, "axis angle");
  expect_rotation(pose_of(rotated(RotationForm::quaternion, {.5, .5, .5, .5})),
                  {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}, "quaternion");
}

TEST(Poses, TranslateAfterRotatingAfterScalingAboutThePivotInMetres) {
  api::ObjectAnimation object = rotated(RotationForm::euler_degrees, {0, 0, 90, 0});
  object.pivot = {10, 0, 0};
  object.translate.keys = {{0, {0, 0, 5}}};
  object.scale.keys = {{0, {2, 3, 4}}};
  const Pose pose = pose_of(object, 0.1);
  // (11, 1, 1) units: from the pivot (1, 1, 1), scaled (2, 3, 4), turned (-3, 2, 4), back (7, 2, 4), moved
  // (7, 2, 9).
  const Vec3 moved = transform_point(pose, {1.1f, 0.1f, 0.1f});
  EXPECT_NEAR(moved.x, 0.7f, 1e-6f);
  EXPECT_NEAR(moved.y, 0.2f, 1e-6f);
  EXPECT_NEAR(moved.z, 0.9f, 1e-6f);
  const Vec3 pivot = transform_point(pose, {1, 0, 0});
  EXPECT_NEAR(pivot.x, 1, 1e-6f);
  EXPECT_NEAR(pivot.z, 0.5f, 1e-6f);
}

TEST(Poses, FromMatricesHaveTheirTranslationInMetresAndNoPivot) {
  api::ObjectAnimation object;
  object.pivot = {100, 100, 100};
  object.matrices = {{0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
  const ObjectMotion motion = motion_of(object, 0.01, 2);
  ASSERT_EQ(motion.spans.size(), 2u);
  EXPECT_EQ(motion.spans[0].pose, (Pose{{{{0, -1, 0, 0.1}, {1, 0, 0, 0.2}, {0, 0, 1, 0.3}}}}));
  EXPECT_EQ(motion.spans[1].pose, Pose{});
}

/// The angle [degrees] by which a pose about the z axis turns x.
double turn_about_z(const Pose& pose) {
  return std::atan2(pose.m[1][0], pose.m[0][0]) * 180 / std::numbers::pi;
}

const Pose& pose_at_frame(const ObjectMotion& motion, FrameIndex frame) {
  for (const PoseSpan& span : motion.spans)
    if (span.first <= frame && frame <= span.last) return span.pose;
  ADD_FAILURE() << "not visible in frame " << frame;
  static const Pose kNone;
  return kNone;
}

api::ObjectAnimation turning(RotationForm form, KeyInterpolation interpolation,
                             std::vector<api::Track<std::array<double, 4>>::Key> keys) {
  api::ObjectAnimation object;
  object.rotate = {form, "xyz", {interpolation, std::move(keys)}};
  return object;
}

std::array<double, 4> quaternion_about_z(double degrees) {
  return {0, 0, std::sin(radians(degrees / 2)), std::cos(radians(degrees / 2))};
}

TEST(Slerp, TurnsAtConstantSpeed) {
  const auto object = turning(RotationForm::quaternion, KeyInterpolation::linear,
                              {{0, quaternion_about_z(10)}, {10, quaternion_about_z(170)}});
  const ObjectMotion motion = motion_of(object, 1, 11);
  for (FrameIndex frame = 0; frame <= 10; ++frame)
    EXPECT_NEAR(turn_about_z(pose_at_frame(motion, frame)), 10 + 16.0 * frame, 1e-9);
}

TEST(Slerp, TakesTheShorterWay) {
  // 350 degrees is -q of -10 degrees; from 10 the short way leads through 0.
  const auto object = turning(RotationForm::quaternion, KeyInterpolation::linear,
                              {{0, quaternion_about_z(10)}, {2, quaternion_about_z(350)}});
  EXPECT_NEAR(turn_about_z(pose_at_frame(motion_of(object, 1, 3), 1)), 0, 1e-9);
}

TEST(Slerp, OfNearlyEqualQuaternionsStaysFinite) {
  const Quaternion a = quaternion_of_axis_angle({0, 0, 1, 30}),
                   b = quaternion_of_axis_angle({0, 0, 1, 30 + 1e-7});
  const Matrix3 m = rotation_of_quaternion(slerp(a, b, 0.5));
  EXPECT_NEAR(std::atan2(m[1][0], m[0][0]), radians(30 + 0.5e-7), 1e-12);
}

TEST(CubicRotations, PassThroughTheirKeys) {
  for (const RotationForm form : {RotationForm::quaternion, RotationForm::axis_angle_degrees}) {
    const bool quaternion = form == RotationForm::quaternion;
    const std::array<double, 4> degrees{0, 40, -60, 200};
    std::vector<api::Track<std::array<double, 4>>::Key> keys;
    for (FrameIndex i = 0; i < 4; ++i)
      keys.push_back({i * i + i, quaternion ? quaternion_about_z(degrees[i])
                                            : std::array<double, 4>{0, 0, 1, degrees[i]}});
    const ObjectMotion motion = motion_of(turning(form, KeyInterpolation::cubic, keys), 1, 13);
    for (FrameIndex i = 0; i < 4; ++i)
      EXPECT_NEAR(std::remainder(turn_about_z(pose_at_frame(motion, i * i + i)) - degrees[i], 360), 0, 1e-9)
          << i;
  }
}

TEST(AxisAngleRotations, MayTurnMoreThanOnceAboutOneAxis) {
  const auto object = turning(RotationForm::axis_angle_degrees, KeyInterpolation::linear,
                              {{0, {0, 0, 1, 0}}, {10, {0, 0, 2, 1080}}, {20, {0, 0, -1, -1080}}});
  const ObjectMotion motion = motion_of(object, 1, 21);
  EXPECT_NEAR(turn_about_z(pose_at_frame(motion, 1)), 108, 1e-9);
  EXPECT_NEAR(turn_about_z(pose_at_frame(motion, 5)), 540 - 720 + 360, 1e-9);
  EXPECT_NEAR(turn_about_z(pose_at_frame(motion, 15)), 0, 1e-9) << "-1080 about -z is 1080 about z";
}

TEST(AxisAngleRotations, AboutDifferentAxesAreJoinedBySlerp) {
  const auto object = turning(RotationForm::axis_angle_degrees, KeyInterpolation::linear,
                              {{0, {1, 0, 0, 90}}, {2, {0, 1, 0, 90}}});
  // Half way between (s,0,0,s) and (0,s,0,s) is (1,1,0,2) / sqrt 6: 2 acos(2/sqrt 6) about (1,1,0).
  const double angle = 2 * std::acos(2 / std::sqrt(6.0)), c = std::cos(angle);
  const Pose pose = pose_at_frame(motion_of(object, 1, 3), 1);
  EXPECT_NEAR(pose.m[0][0], (1 + c) / 2, kRounding);
  EXPECT_NEAR(pose.m[0][1], (1 - c) / 2, kRounding);
  EXPECT_NEAR(pose.m[2][2], c, kRounding);
}

TEST(Spans, MergeFramesInWhichNothingMoves) {
  api::ObjectAnimation object;
  object.translate = {KeyInterpolation::linear, {{2, {1.1, 2.2, 3.3}}, {5, {1.1, 2.2, 3.3}}, {7, {2, 2, 2}}}};
  const ObjectMotion motion = motion_of(object, 0.3, 10);
  ASSERT_EQ(motion.spans.size(), 3u);
  EXPECT_EQ(motion.spans[0].first, 0u);
  EXPECT_EQ(motion.spans[0].last, 5u);
  EXPECT_EQ(motion.spans[1].first, 6u);
  EXPECT_EQ(motion.spans[1].last, 6u);
  EXPECT_EQ(motion.spans[2].first, 7u);
  EXPECT_EQ(motion.spans[2].last, 9u);
  EXPECT_FALSE(motion.is_static(10));
}

TEST(Spans, OfEveryHeldRotationAreOne) {
  const std::array<double, 4> any{0.3, -0.2, 0.7, 0.4};
  for (const RotationForm form :
       {RotationForm::euler_degrees, RotationForm::axis_angle_degrees, RotationForm::quaternion})
    for (const KeyInterpolation kind :
         {KeyInterpolation::linear, KeyInterpolation::cubic, KeyInterpolation::step})
      EXPECT_TRUE(motion_of(turning(form, kind, {{1, any}, {4, any}, {9, any}}), 0.3, 12).is_static(12));
}

TEST(Spans, LeaveOutFramesInWhichTheObjectIsNotVisible) {
  api::ObjectAnimation object;
  object.visible.keys = {{0, false}, {2, true}, {5, false}, {6, true}};
  const ObjectMotion motion = motion_of(object, 1, 8);
  ASSERT_EQ(motion.spans.size(), 2u);
  EXPECT_EQ(motion.spans[0].first, 2u);
  EXPECT_EQ(motion.spans[0].last, 4u);
  EXPECT_EQ(motion.spans[1].first, 6u);
  EXPECT_EQ(motion.spans[1].last, 7u);
  EXPECT_FALSE(motion.is_static(8));
  object.visible.keys = {{0, false}};
  EXPECT_TRUE(motion_of(object, 1, 8).spans.empty());
}

TEST(CubicScales, NeverTurnAnObjectInsideOut) {
  api::ObjectAnimation object;
  object.scale = {KeyInterpolation::cubic,
                  {{0, {9, 9, 9}}, {10, {0.1, 0.1, 0.1}}, {20, {0.1, 0.1, 0.1}}, {30, {9, 9, 9}}}};
  const ObjectMotion motion = motion_of(object, 1, 31);
  double smallest = 9;
  for (FrameIndex frame = 0; frame <= 30; ++frame)
    smallest = std::min(smallest, pose_at_frame(motion, frame).m[0][0]);
  EXPECT_DOUBLE_EQ(smallest, 0.001) << "the spline alone would be about -1.1";
}

}  // namespace
}  // namespace engine
