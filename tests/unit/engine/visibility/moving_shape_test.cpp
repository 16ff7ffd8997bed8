#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::World;

constexpr FrameIndex kFrames = 100;
constexpr std::size_t kNoneFlat = 0;

/// Two closed boxes over a floor.
Scene boxes() {
  Scene scene = tests::scene_with(3, 1);
  tests::add_polygon(scene, {{-5, -5, -3}, {5, -5, -3}, {5, 5, -3}, {-5, 5, -3}});
  tests::add_box(scene, {-0.6f, -0.4f, -0.3f}, {0.6f, 0.4f, 0.3f}, false, 1);
  tests::add_box(scene, {-0.2f, -0.9f, -0.5f}, {0.3f, 0.5f, 0.5f}, false, 2);
  return scene;
}

/// Turned about z, longer along x, and put somewhere; `mirror`: -1 turns it inside out as a mirror does.
Pose turned(double angle, double stretch, double mirror, double x, double z) {
  const double c = std::cos(angle), s = std::sin(angle);
  Pose pose;
  pose.m = {{{stretch * c, -s * mirror, 0, x}, {stretch * s, c * mirror, 0, 0.3 * x}, {0, 0, 1, z}}};
  return pose;
}

/// The first turns and is away for a while; the second is a mirrored one that rests for five frames at a
/// time.
Animation turning(const Scene& scene) {
  Animation animation = tests::still(scene, kFrames);
  for (const std::uint32_t object : {1u, 2u}) animation.objects[object].spans.clear();
  for (FrameIndex f = 0; f < kFrames; ++f)
    if (f < 40 || f > 50)
      animation.objects[1].spans.push_back({f, f, turned(0.1 * f, 1.5, 1, std::sin(0.2 * f), 0.2)});
  for (FrameIndex f = 0; f + 4 < kFrames; f += 5)
    animation.objects[2].spans.push_back({f, f + 4, turned(-0.05 * f, 0.7, -1, std::cos(0.1 * f), -0.4)});
  return animation;
}

struct BothWays {
  World world{boxes(), turning(boxes()), 1.0};
  std::vector<FrameIndex> frames = world.all_frames();
  MovingRays flat{world.patches, world.animation, frames};
  MovingRays shapes{world.patches, world.animation, frames, kNoneFlat};
};

TEST(MovingShape, BlocksTheSlotsThatTheFlatTreeDoes) {
  const BothWays both;
  tests::RandomRays random(1.5f, 3);
  int partly = 0;
  for (int k = 0; k < 2'000; ++k) {
    const Ray ray = random.next();
    const SlotMask mask = both.shapes.blocked(ray);
    ASSERT_EQ(mask.bits, both.flat.blocked(ray).bits) << k;
    int blocked = 0;
    for (std::uint32_t slot = 0; slot < kFrames; slot += 7) {
      ASSERT_EQ(both.shapes.occluded(ray, slot), mask.test(slot)) << k << " " << slot;
      blocked += mask.test(slot) ? 1 : 0;
    }
    partly += blocked > 0 && blocked < 14 ? 1 : 0;
  }
  EXPECT_GT(partly, 500);
}

TEST(MovingShape, IsHitWhereTheFlatTreeIs) {
  const BothWays both;
  tests::RandomRays random(1.5f, 5);
  int hits = 0;
  for (int k = 0; k < 2'000; ++k) {
    const Ray ray = random.next();
    for (std::uint32_t slot = 0; slot < kFrames; slot += 7) {
      SurfaceHit of_shape, of_flat;
      const bool met = both.shapes.nearest(ray, slot, of_shape);
      ASSERT_EQ(met, both.flat.nearest(ray, slot, of_flat)) << k << " " << slot;
      if (!met) continue;
      ASSERT_EQ(of_shape.facet, of_flat.facet) << k << " " << slot;
      ASSERT_EQ(of_shape.front, of_flat.front);
      ASSERT_NEAR(of_shape.distance, of_flat.distance, 1e-5);
      ASSERT_NEAR(of_shape.u, of_flat.u, 1e-4);
      ASSERT_NEAR(of_shape.v, of_flat.v, 1e-4);
      ++hits;
    }
  }
  EXPECT_GT(hits, 5'000);
}

TEST(MovingShape, AllItsHitsAreThoseOfTheFlatTree) {
  const BothWays both;
  tests::RandomRays random(1.5f, 7);
  std::vector<MovingHit> of_shapes, of_flat;
  for (int k = 0; k < 500; ++k) {
    const Ray ray = random.next();
    both.shapes.all_hits(ray, of_shapes);
    both.flat.all_hits(ray, of_flat);
    ASSERT_EQ(of_shapes.size(), of_flat.size()) << k;
    for (std::size_t h = 0; h < of_flat.size(); ++h)
      ASSERT_NEAR(of_shapes[h].distance, of_flat[h].distance, 1e-5) << k;
  }
}

// There is no way back from a plane into the object: its facets are in the flat tree then.
TEST(MovingShape, AnObjectThatAPoseFlattensStillBlocks) {
  Animation animation = turning(boxes());
  Pose flat;
  flat.m[2] = {0, 0, 0, 1};
  animation.objects[1].spans[3].pose = flat;
  const World world(boxes(), animation, 1.0);
  const MovingRays rays(world.patches, animation, world.all_frames(), kNoneFlat);
  EXPECT_TRUE(rays.occluded({{0.1f, 0.1f, 2}, {0, 0, -1}, 0, 1.5f}, 3));
  EXPECT_FALSE(rays.occluded({{0.1f, 0.1f, 2}, {0, 0, -1}, 0, 0.5f}, 3));
}

}  // namespace
}  // namespace engine
