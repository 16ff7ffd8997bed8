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

// A quad and a triangle at an edge whose ends are no sums of floats, turned and moved: origin + edge_u would
// miss both the vertex and the neighbour's corner.
TEST(Place, NeighboursShareTheirVerticesBitForBit) {
  const Vec3 a{0.1f, 0.7f, 0.3f}, b{1.3f, 0.9f, -0.4f}, c{1.6f, 2.9f, 0.33f}, d{2.7f, 0.2f, 0.11f};
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {a, b, c, c + (a - b)});
  tests::add_polygon(scene, {b, d, c});
  const Patches patches = *mesh_into_patches(scene, 10);
  ASSERT_EQ(patches.facets.size(), 2u);
  ASSERT_FALSE(patches.facets[0].is_triangle);
  EXPECT_EQ(patches.facets[0].corners[1], b);
  EXPECT_EQ(patches.facets[0].corners[2], c);
  Pose pose;
  pose.m = {{{0.6, -0.8, 0, 31.7}, {0.8, 0.6, 0, -12.3}, {0, 0, 1, 0.7}}};
  const PlacedFacet quad = place(patches.facets[0], pose), triangle = place(patches.facets[1], pose);
  EXPECT_EQ(quad.corners[0], quad.origin);
  EXPECT_EQ(quad.corners[1], triangle.corners[0]);
  EXPECT_EQ(quad.corners[2], triangle.corners[2]);
  EXPECT_EQ(quad.corners[1], transform_point(pose, b));
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
