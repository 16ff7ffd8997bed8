// Facets that lie in one place: which of them is seen is settled by their order, never by Embree's tree.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::World;

constexpr std::uint32_t kObjects = 5'000;

/// One quad and one triangle in one place for each object, each object of another material.
Scene coincident_facets() {
  Scene scene = tests::scene_with(kObjects, kObjects);
  for (std::uint32_t object = 0; object < kObjects; ++object) {
    const std::uint32_t material = kObjects - 1 - object;
    tests::add_polygon(scene, {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}}, object, material);
    tests::add_polygon(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, object, material);
  }
  return scene;
}

std::vector<Ray> rays_down(int count) {
  tests::RandomRays random(0.9f, 3);
  std::vector<Ray> rays;
  for (int k = 0; k < count; ++k) {
    const Vec3 target = random.point();
    rays.push_back({{target.x, target.y, 2}, {0, 0, -1}});
  }
  return rays;
}

/// Of those that a ray straight down meets: all in the lower left half, the quads alone beyond it.
std::uint32_t first_facet(const Ray& ray) {
  return ray.origin.x + ray.origin.y < 0 ? 0 : 1;
}

TEST(Ties, OfThousandsOfFacetsInOnePlaceTheFirstIsSeen) {
  const Scene scene = coincident_facets();
  const auto rays = rays_down(50);
  for (const std::size_t threads : {1u, 2u, 2u, 1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const World world(scene, tests::still(scene, 1), 10);
    for (const Ray& ray : rays) {
      SurfaceHit hit;
      ASSERT_TRUE(world.static_rays.nearest(ray, hit));
      ASSERT_EQ(hit.facet, first_facet(ray));
      ASSERT_EQ(hit.distance, 2);
    }
  }
}

// Object k is there from frame k on: in frame f, object 0 is, and in a window of late frames as well.
TEST(Ties, OfThousandsOfMovingFacetsInOnePlaceTheFirstIsSeenInEverySlot) {
  const Scene scene = coincident_facets();
  const auto rays = rays_down(20);
  constexpr FrameIndex kFrames = 4;
  Animation animation = tests::still(scene, kFrames);
  for (std::uint32_t object = 0; object < kObjects; ++object)
    animation.objects[object].spans = {{object % kFrames, object % kFrames, {}}};
  for (const std::size_t threads : {1u, 2u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const World world(scene, animation, 10);
    const MovingRays moving(world.patches, animation, world.all_frames());
    for (const Ray& ray : rays)
      for (std::uint32_t slot = 0; slot < kFrames; ++slot) {
        SurfaceHit hit;
        ASSERT_TRUE(moving.nearest(ray, slot, hit));
        ASSERT_EQ(hit.facet, 2 * slot + first_facet(ray));
      }
  }
}

// The edge of an eave, from above: the roof's front and the back of what folds under it, at one distance. The
// latter comes first in the scene.
TEST(Ties, AtASilhouetteTheFrontIsSeen) {
  Scene scene = tests::scene_with(2, 1);
  tests::add_polygon(scene, {{0, 1, 0}, {0, -1, 0}, {-1, -1, -3}, {-1, 1, -3}}, 0);
  tests::add_polygon(scene, {{0, -1, 0}, {0, 1, 0}, {-1, 1, -2}, {-1, -1, -2}}, 1);
  const World world(scene, tests::still(scene, 2), 10);
  Animation moves = tests::still(scene, 2);
  for (auto& object : moves.objects) object.spans = {{1, 1, {}}};
  const MovingRays moving(world.patches, moves, std::vector<FrameIndex>{0, 1});
  std::vector<SurfaceHit> hits;
  for (const float y : {-0.75f, -0.5f, 0.0f, 0.125f, 0.625f}) {
    const Ray ray{{0, y, 2}, {0, 0, -1}};
    world.static_rays.all_hits(ray, hits);
    ASSERT_EQ(hits.size(), 2u);
    ASSERT_EQ(hits[0].distance, hits[1].distance);
    SurfaceHit still, moved;
    ASSERT_TRUE(world.static_rays.nearest(ray, still) && moving.nearest(ray, 1, moved));
    EXPECT_TRUE(still.front && moved.front);
    EXPECT_EQ(still.facet, 1u);
    EXPECT_EQ(moved.facet, 1u);
  }
}

// On the diagonal of a quad both its halves are hit, on a shared edge both its facets.
TEST(Ties, OnEdgesAndDiagonalsTheNearestIsTheFirstOfAllHits) {
  Scene scene = tests::scene_with(1, 1);
  for (int i = -8; i < 8; ++i)
    for (int j = -8; j < 8; ++j) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      tests::add_polygon(scene, {{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}});
    }
  const World world(scene, tests::still(scene, 1), 10);
  std::vector<SurfaceHit> hits;
  for (int i = -31; i < 32; ++i)
    for (int j = -31; j < 32; ++j) {
      const Ray ray{{static_cast<float>(i) / 4, static_cast<float>(j) / 4, 2}, {0, 0, -1}};
      SurfaceHit nearest;
      world.static_rays.all_hits(ray, hits);
      ASSERT_EQ(hits.size(), 1u) << i << ' ' << j;
      ASSERT_TRUE(world.static_rays.nearest(ray, nearest));
      EXPECT_EQ(nearest.facet, hits[0].facet);
      EXPECT_EQ(nearest.u, hits[0].u);
      EXPECT_EQ(nearest.v, hits[0].v);
    }
}

}  // namespace
}  // namespace engine
