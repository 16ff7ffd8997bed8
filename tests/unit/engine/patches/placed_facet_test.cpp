#include "engine/patches/placed_facet.h"

#include <gtest/gtest.h>

#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

Facet unit_square() {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  return mesh_into_patches(scene, 1.0)->facets[0];
}

Pose scaled(double x, double y, double z) {
  Pose pose;
  pose.m[0][0] = x;
  pose.m[1][1] = y;
  pose.m[2][2] = z;
  return pose;
}

TEST(Place, AMovedFacetKeepsItsEdgesAndNormal) {
  const PlacedFacet placed = place(unit_square(), tests::moved_to(3, -2, 7));
  EXPECT_EQ(placed.origin, (Vec3{3, -2, 8}));
  EXPECT_EQ(placed.edge_u, (Vec3{1, 0, 0}));
  EXPECT_EQ(placed.edge_v, (Vec3{0, 1, 0}));
  EXPECT_EQ(placed.normal, (Vec3{0, 0, 1}));
}

// The front faces +z. A mirror in x or y leaves it there; one in z turns it, with the point in front of it.
TEST(Place, AMirrorKeepsAFrontAFront) {
  EXPECT_EQ(place(unit_square(), scaled(-1, 1, 1)).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(place(unit_square(), scaled(1, -2, 1)).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(place(unit_square(), scaled(1, 1, -1)).normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(place(unit_square(), scaled(-1, -1, 1)).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(place(unit_square(), scaled(-1, -1, -1)).normal, (Vec3{0, 0, -1}));
}

// x' = y, y' = -x, then x is stretched threefold.
TEST(Place, TheNormalIsUnitAndPerpendicularWhateverThePose) {
  Pose pose;
  pose.m = {{{0, 3, 0, 1}, {-1, 0, 0.5, 2}, {0.25, 0, 2, 3}}};
  const PlacedFacet placed = place(unit_square(), pose);
  EXPECT_FLOAT_EQ(length(placed.normal), 1);
  EXPECT_NEAR(dot(placed.normal, placed.edge_u), 0, 1e-6);
  EXPECT_NEAR(dot(placed.normal, placed.edge_v), 0, 1e-6);
  const Vec3 in_front = transform_point(pose, {0.5f, 0.5f, 2});
  EXPECT_GT(dot(placed.normal, in_front - placed.origin), 0);
}

TEST(Place, APoseThatFlattensItsObjectLeavesNoNormal) {
  EXPECT_EQ(place(unit_square(), scaled(0, 1, 1)).normal, (Vec3{0, 0, 0}));
}

ObjectMotion motion_of(std::initializer_list<std::pair<FrameIndex, FrameIndex>> spans) {
  ObjectMotion motion;
  for (const auto& [first, last] : spans) motion.spans.push_back({first, last, tests::moved_to(first, 0, 0)});
  return motion;
}

void expect_ranges(const ObjectMotion& motion, const std::vector<FrameIndex>& frames,
                   const std::vector<std::array<std::uint32_t, 3>>& expected) {
  const auto ranges = placed_ranges(motion, frames);
  ASSERT_EQ(ranges.size(), expected.size());
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    EXPECT_EQ(ranges[k].pose, &motion.spans[expected[k][0]].pose) << k;
    EXPECT_EQ(ranges[k].first_slot, expected[k][1]) << k;
    EXPECT_EQ(ranges[k].last_slot, expected[k][2]) << k;
  }
}

// Expected: {span, first slot, last slot}.
TEST(PlacedRanges, AWindowHoldsTheSpansThatMeetItsFrames) {
  const ObjectMotion motion = motion_of({{0, 4}, {5, 5}, {8, 19}});
  expect_ranges(motion, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {{0, 0, 4}, {1, 5, 5}, {2, 8, 9}});
  expect_ranges(motion, {3, 7, 10, 19}, {{0, 0, 0}, {2, 2, 3}});
  expect_ranges(motion, {6, 7}, {});
  expect_ranges(motion, {5}, {{1, 0, 0}});
  expect_ranges(motion, {20, 25}, {});
  expect_ranges(motion, {0, 4, 6, 8}, {{0, 0, 1}, {2, 3, 3}});
}

TEST(PlacedRanges, AnObjectThatIsNeverThereHasNone) {
  EXPECT_TRUE(placed_ranges(ObjectMotion{}, std::vector<FrameIndex>{0, 1, 2}).empty());
}

}  // namespace
}  // namespace engine
