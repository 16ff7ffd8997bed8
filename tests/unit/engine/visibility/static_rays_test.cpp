#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::add_polygon;
using tests::World;

/// `count` squares [-1, 1]^2 at z = 0, 1, 2, ...; those of odd height face down.
Scene stack(int count) {
  Scene scene = tests::scene_with(1, 1);
  for (int k = 0; k < count; ++k) {
    const auto z = static_cast<float>(k);
    if (k % 2 == 0)
      add_polygon(scene, {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}});
    else
      add_polygon(scene, {{-1, 1, z}, {1, 1, z}, {1, -1, z}, {-1, -1, z}});
  }
  return scene;
}

TEST(StaticRays, ARayThroughAStackHitsEverySheetInOrderWithItsSide) {
  const Scene scene = stack(40);
  const World world(scene, tests::still(scene, 1), 1.0);
  std::vector<SurfaceHit> hits{{}, {}, {}};  // what was there before goes
  world.static_rays.all_hits({{0.3f, -0.2f, 50}, {0, 0, -2}}, hits);
  ASSERT_EQ(hits.size(), 40u);
  for (std::uint32_t k = 0; k < 40; ++k) {
    const std::uint32_t sheet = 39 - k;
    EXPECT_EQ(hits[k].facet, sheet);
    EXPECT_FLOAT_EQ(hits[k].distance, (50.0f - static_cast<float>(sheet)) / 2);
    EXPECT_EQ(hits[k].front, sheet % 2 == 0) << sheet;
  }
}

TEST(StaticRays, OnlyHitsBetweenNearAndFarCount) {
  const Scene scene = stack(10);
  const World world(scene, tests::still(scene, 1), 1.0);
  std::vector<SurfaceHit> hits;
  world.static_rays.all_hits({{0.1f, 0.2f, -1}, {0, 0, 1}, 2.5f, 6.5f}, hits);
  ASSERT_EQ(hits.size(), 4u);
  EXPECT_EQ(hits.front().facet, 2u);
  EXPECT_EQ(hits.back().facet, 5u);
  EXPECT_TRUE(world.static_rays.occluded({{0.1f, 0.2f, -1}, {0, 0, 1}, 2.5f, 6.5f}));
  EXPECT_FALSE(world.static_rays.occluded({{0.1f, 0.2f, -1}, {0, 0, 1}, 2.2f, 2.8f}));
}

TEST(StaticRays, WhereNothingIsNothingIsHit) {
  const Scene scene = stack(3);
  const World world(scene, tests::still(scene, 1), 1.0);
  const Ray beside{{5, 5, -1}, {0, 0, 1}};
  std::vector<SurfaceHit> hits{{}};
  world.static_rays.all_hits(beside, hits);
  EXPECT_TRUE(hits.empty());
  EXPECT_FALSE(world.static_rays.occluded(beside));
  SurfaceHit hit;
  EXPECT_FALSE(world.static_rays.nearest(beside, hit));
}

TEST(StaticRays, ASceneInWhichEverythingMovesIsEmptyToThem) {
  const Scene scene = stack(3);
  Animation animation = tests::still(scene, 2);
  animation.objects[0].spans = {{0, 0, {}}, {1, 1, tests::moved_to(0, 0, 9)}};
  const World world(scene, animation, 1.0);
  std::vector<SurfaceHit> hits{{}};
  world.static_rays.all_hits({{0, 0, -1}, {0, 0, 1}}, hits);
  EXPECT_TRUE(hits.empty());
  EXPECT_FALSE(world.static_rays.occluded({{0, 0, -1}, {0, 0, 1}}));
}

TEST(StaticRays, APoseThatAnObjectKeepsIsApplied) {
  const Scene scene = stack(1);
  Animation animation = tests::still(scene, 3);
  Pose pose = tests::moved_to(10, 0, 5);
  pose.m[0][0] = 2;
  animation.objects[0].spans[0].pose = pose;
  const World world(scene, animation, 1.0);
  SurfaceHit hit;
  ASSERT_TRUE(world.static_rays.nearest({{11.5f, 0.5f, 0}, {0, 0, 1}}, hit));
  EXPECT_FLOAT_EQ(hit.distance, 5);
  EXPECT_FLOAT_EQ(hit.u, 0.875f);
  EXPECT_FLOAT_EQ(hit.v, 0.75f);
  EXPECT_FALSE(hit.front);
  EXPECT_FALSE(world.static_rays.nearest({{0.5f, 0.5f, 0}, {0, 0, 1}}, hit));
}

// Both kinds of facets, in general position.
TEST(StaticRays, UAndVGiveThePositionOfTheHit) {
  Scene scene = tests::scene_with(1, 1);
  add_polygon(scene, {{-1, -2, 0.1f}, {2, -1.5f, 0.4f}, {2.5f, 1, 1.2f}, {-0.5f, 0.5f, 0.9f}});
  add_polygon(scene, {{-2, -2, -1}, {2, -1, -0.5f}, {0, 2, -1.5f}});
  const World world(scene, tests::still(scene, 1), 1.0);
  ASSERT_FALSE(world.patches.facets[0].is_triangle);
  tests::RandomRays rays(3, 1);
  std::vector<SurfaceHit> hits;
  int found[2] = {0, 0};
  for (int k = 0; k < 20'000; ++k) {
    const Ray ray = rays.next();
    world.static_rays.all_hits(ray, hits);
    for (const SurfaceHit& hit : hits) {
      const Vec3 on_ray = ray.origin + hit.distance * ray.direction;
      ASSERT_LT(length(tests::position_of(world.patches, hit) - on_ray), 1e-5f);
      ASSERT_EQ(hit.front, dot(world.patches.facets[hit.facet].normal, ray.direction) < 0);
      ++found[hit.facet];
    }
  }
  EXPECT_GT(found[0], 1000);
  EXPECT_GT(found[1], 1000);
}

TEST(StaticRays, TheNearestHitIsTheFirstOfAllAndSomethingOccludesIffThereIsOne) {
  Scene scene = tests::scene_with(1, 1);
  tests::RandomRays random(1, 2);
  for (int k = 0; k < 60; ++k) add_polygon(scene, {random.point(), random.point(), random.point()});
  const World world(scene, tests::still(scene, 1), 10.0);
  tests::RandomRays rays(1.2f, 3);
  std::vector<SurfaceHit> hits;
  std::size_t total = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Ray ray = rays.next();
    world.static_rays.all_hits(ray, hits);
    total += hits.size();
    for (std::size_t h = 1; h < hits.size(); ++h) ASSERT_LE(hits[h - 1].distance, hits[h].distance);
    SurfaceHit nearest;
    ASSERT_EQ(world.static_rays.nearest(ray, nearest), !hits.empty());
    ASSERT_EQ(world.static_rays.occluded(ray), !hits.empty());
    if (hits.empty()) continue;
    ASSERT_EQ(nearest.facet, hits[0].facet);
    ASSERT_EQ(nearest.distance, hits[0].distance);
    ASSERT_EQ(nearest.u, hits[0].u);
    ASSERT_EQ(nearest.front, hits[0].front);
  }
  EXPECT_GT(total, 20'000u);
}

}  // namespace
}  // namespace engine
