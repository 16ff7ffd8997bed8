// Rays exactly through the edges that facets share: each surface is crossed once, never twice, never not.
#include <gtest/gtest.h>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::add_polygon;
using tests::World;

/// Rays from everywhere above through points at z = 0.
std::vector<Ray> rays_through(const std::vector<Vec3>& points, unsigned seed) {
  tests::RandomRays random(2, seed);
  std::vector<Ray> rays;
  for (const Vec3 point : points) {
    Vec3 from = random.point();
    from.z = 1 + std::abs(from.z);
    rays.push_back({from, 2.0f * (point - from), 0.0f, 1.0f});
    rays.push_back({{point.x, point.y, 3}, {0, 0, -4}, 0.0f, 1.0f});  // straight down: exact in floats
  }
  return rays;
}

void expect_one_hit_each(const World& world, const std::vector<Ray>& rays) {
  std::vector<SurfaceHit> hits;
  std::vector<std::size_t> histogram(4, 0);
  for (const Ray& ray : rays) {
    world.static_rays.all_hits(ray, hits);
    ++histogram[std::min<std::size_t>(hits.size(), 3)];
    EXPECT_TRUE(world.static_rays.occluded(ray));
  }
  EXPECT_EQ(histogram[1], rays.size())
      << "not hit: " << histogram[0] << ", twice: " << histogram[2] << ", more: " << histogram[3];
}

std::vector<Vec3> points_between(Vec3 a, Vec3 b, int count) {
  std::vector<Vec3> points;
  for (int k = 1; k < count; ++k) {
    const float s = static_cast<float>(k) / static_cast<float>(count);
    points.push_back(a + s * (b - a));
  }
  return points;
}

TEST(SharedEdges, TheDiagonalsOfAParallelogramAreCrossedOnce) {
  Scene scene = tests::scene_with(1, 1);
  add_polygon(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  const World world(scene, tests::still(scene, 1), 1.0);
  expect_one_hit_each(world, rays_through(points_between({-1, -1, 0}, {1, 1, 0}, 1024), 1));
  expect_one_hit_each(world, rays_through(points_between({1, -1, 0}, {-1, 1, 0}, 1024), 2));
}

TEST(SharedEdges, TheEdgeOfTwoParallelogramsIsCrossedOnce) {
  Scene scene = tests::scene_with(1, 1);
  add_polygon(scene, {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}});
  add_polygon(scene, {{0, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 1, 0}});
  const World world(scene, tests::still(scene, 1), 1.0);
  expect_one_hit_each(world, rays_through(points_between({0, -1, 0}, {0, 1, 0}, 2048), 3));
}

TEST(SharedEdges, TheEdgesOfAFanOfTrianglesAndTheirCommonCornerAreCrossedOnce) {
  Scene scene = tests::scene_with(1, 1);
  const Vec3 rim[5] = {{1, 0, 0}, {0.3f, 0.9f, 0}, {-0.8f, 0.6f, 0}, {-0.7f, -0.7f, 0}, {0.4f, -0.9f, 0}};
  for (int k = 0; k < 5; ++k) add_polygon(scene, {{0, 0, 0}, rim[k], rim[(k + 1) % 5]});
  const World world(scene, tests::still(scene, 1), 1.0);
  for (const Vec3 end : rim) expect_one_hit_each(world, rays_through(points_between({0, 0, 0}, end, 512), 4));
  expect_one_hit_each(world, rays_through({{0, 0, 0}}, 5));
}

TEST(SharedEdges, SheetsBackToBackAreTwoCrossings) {
  Scene scene = tests::scene_with(1, 1);
  add_polygon(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  add_polygon(scene, {{-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}});
  const World world(scene, tests::still(scene, 1), 1.0);
  std::vector<SurfaceHit> hits;
  world.static_rays.all_hits({{0.25f, 0.5f, 3}, {0, 0, -1}}, hits);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NE(hits[0].front, hits[1].front);
}

// Two such sheets of two facets each: a ray through both edges meets four facets at one distance.
TEST(SharedEdges, TheEdgesOfSheetsBackToBackAreCrossedOnceFromEachSide) {
  Scene scene = tests::scene_with(1, 1);
  for (const float x : {-1.0f, 0.0f}) {
    add_polygon(scene, {{x, -1, 0}, {x + 1, -1, 0}, {x + 1, 1, 0}, {x, 1, 0}});
    add_polygon(scene, {{x, 1, 0}, {x + 1, 1, 0}, {x + 1, -1, 0}, {x, -1, 0}});
  }
  const World world(scene, tests::still(scene, 1), 1.0);
  std::vector<SurfaceHit> hits;
  for (const Ray& ray : rays_through(points_between({0, -1, 0}, {0, 1, 0}, 64), 6)) {
    world.static_rays.all_hits(ray, hits);
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_NE(hits[0].front, hits[1].front);
  }
}

// A closed box far from the origin: a line enters and leaves it, through faces, edges or corners alike.
TEST(SharedEdges, LinesThroughTheEdgesOfABoxEnterAndLeaveIt) {
  Scene scene = tests::scene_with(1, 1);
  const Vec3 at{37, -12, 5};
  tests::add_box(scene, at + Vec3{-1, -1, -1}, at + Vec3{1, 1, 1}, false);
  const World world(scene, tests::still(scene, 1), 1.0);
  std::vector<SurfaceHit> hits;
  int lost = 0, lines = 0;
  for (int k = 1; k < 1024; ++k) {
    const float s = -1 + 2 * static_cast<float>(k) / 1024;
    // Through an edge of the top and the middle of the box; such a line leaves through the opposite edge.
    const Vec3 on_edge = at + Vec3{s, 1, 1};
    const Vec3 direction = at - on_edge;
    world.static_rays.all_hits({on_edge - 2.0f * direction, direction}, hits);
    ++lines;
    int fronts = 0, backs = 0;
    for (const SurfaceHit& hit : hits) ++(hit.front ? fronts : backs);
    lost += fronts == 1 && backs == 1 ? 0 : 1;
  }
  EXPECT_EQ(lost, 0) << "of " << lines;
}

}  // namespace
}  // namespace engine
