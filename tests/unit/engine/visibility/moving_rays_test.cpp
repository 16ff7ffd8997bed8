#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::moved_to;
using tests::World;

/// Object 0 is a floor that rests; objects 1 .. n are boxes whose spans the tests set.
Scene floor_and_boxes(std::uint32_t boxes) {
  Scene scene = tests::scene_with(1 + boxes, 1);
  tests::add_polygon(scene, {{-5, -5, -3}, {5, -5, -3}, {5, 5, -3}, {-5, 5, -3}});
  for (std::uint32_t b = 1; b <= boxes; ++b)
    tests::add_box(scene, {-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f}, false, b);
  return scene;
}

/// Boxes that wander: each rests for 1 .. 4 frames, and is away for some. The same for every call.
Animation wandering(const Scene& scene, FrameIndex frames) {
  Animation animation = tests::still(scene, frames);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> where(-1, 1);
  for (std::size_t object = 1; object < animation.objects.size(); ++object) {
    auto& spans = animation.objects[object].spans;
    spans.clear();
    for (FrameIndex frame = 0; frame < frames;) {
      const FrameIndex last = std::min<FrameIndex>(frame + random() % 4, frames - 1);
      const double x = where(random), y = where(random), z = where(random);
      if (random() % 5 != 0) spans.push_back({frame, last, moved_to(x, y, z)});
      frame = last + 1;
    }
  }
  return animation;
}

/// The pose of an object in a frame; null where it is away.
const Pose* pose_in(const Animation& animation, std::uint32_t object, FrameIndex frame) {
  for (const PoseSpan& span : animation.objects[object].spans)
    if (span.first <= frame && frame <= span.last) return &span.pose;
  return nullptr;
}

struct Window {
  World world;
  std::vector<FrameIndex> frames;
  MovingRays rays;

  Window(std::uint32_t boxes, FrameIndex frame_count, std::vector<FrameIndex> of)
      : world(floor_and_boxes(boxes), wandering(floor_and_boxes(boxes), frame_count), 1.0),
        frames(std::move(of)),
        rays(world.patches, world.animation, frames) {}
  explicit Window(FrameIndex count) : Window(3, count, every(1, count)) {}

  static std::vector<FrameIndex> every(FrameIndex step, FrameIndex end) {
    std::vector<FrameIndex> frames;
    for (FrameIndex f = 0; f < end; f += step) frames.push_back(f);
    return frames;
  }
};

TEST(SlotMask, SetsTheSlotsOfARangeAndNoOthers) {
  for (const auto& [first, last] : {std::pair{0u, 0u}, {0u, 127u}, {60u, 70u}, {63u, 64u}, {127u, 127u}}) {
    SlotMask mask;
    mask.set(first, last);
    for (std::uint32_t s = 0; s < kWindowMax; ++s) EXPECT_EQ(mask.test(s), first <= s && s <= last);
  }
}

TEST(MovingRays, NothingMovesNothingIsHit) {
  const Scene scene = floor_and_boxes(2);
  const World world(scene, tests::still(scene, 4), 1.0);
  const MovingRays rays(world.patches, world.animation, world.all_frames());
  EXPECT_TRUE(rays.empty());
  const Ray ray{{0.1f, 0.2f, 5}, {0, 0, -1}};
  std::vector<MovingHit> hits{{}};
  rays.all_hits(ray, hits);
  EXPECT_TRUE(hits.empty());
  EXPECT_EQ(rays.blocked(ray).bits, SlotMask{}.bits);
  EXPECT_FALSE(rays.occluded(ray, 0));
  SurfaceHit hit;
  EXPECT_FALSE(rays.nearest(ray, 0, hit));
}

TEST(MovingRays, AnObjectOutsideTheWindowIsNotThere) {
  Scene scene = floor_and_boxes(1);
  Animation animation = tests::still(scene, 10);
  animation.objects[1].spans = {{0, 3, {}}};
  const World world(scene, animation, 1.0);
  EXPECT_TRUE(MovingRays(world.patches, animation, std::vector<FrameIndex>{4, 9}).empty());
  const MovingRays rays(world.patches, animation, std::vector<FrameIndex>{1, 3, 5, 9});
  const SlotMask mask = rays.blocked({{0.1f, 0.2f, 5}, {0, 0, -1}});
  for (std::uint32_t slot = 0; slot < 4; ++slot) EXPECT_EQ(mask.test(slot), slot < 2) << slot;
}

// The wing of a box seen from above: in at the front of its top, out at the back of its bottom.
TEST(MovingRays, HitsCarryTheSlotsOfTheirPose) {
  Scene scene = floor_and_boxes(1);
  Animation animation = tests::still(scene, 8);
  animation.objects[1].spans = {
      {1, 3, moved_to(0, 0, 1)}, {4, 4, moved_to(9, 0, 0)}, {6, 7, moved_to(0, 0, -1)}};
  const World world(scene, animation, 1.0);
  const MovingRays rays(world.patches, animation, world.all_frames());
  std::vector<MovingHit> hits;
  rays.all_hits({{0.1f, 0.2f, 5}, {0, 0, -1}}, hits);
  ASSERT_EQ(hits.size(), 4u);
  const float expected[4] = {3.6f, 4.4f, 5.6f, 6.4f};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_FLOAT_EQ(hits[k].distance, expected[k]);
    EXPECT_EQ(hits[k].front, k % 2 == 0);
    EXPECT_EQ(hits[k].first_slot, k < 2 ? 1u : 6u);
    EXPECT_EQ(hits[k].last_slot, k < 2 ? 3u : 7u);
  }
}

// Per frame, the hits of a window are those of the same frame with its objects at rest.
void expect_as_at_rest(const Window& window, int ray_count) {
  tests::RandomRays random(2, 11);
  std::vector<Ray> rays;
  for (int k = 0; k < ray_count; ++k) rays.push_back(random.next());
  std::vector<MovingHit> moving;
  std::vector<SurfaceHit> rested;
  std::size_t total = 0;
  for (std::uint32_t slot = 0; slot < window.frames.size(); ++slot) {
    Animation rest = tests::still(window.world.scene, 1);
    rest.objects[0].spans.clear();  // the floor does not move
    for (std::uint32_t object = 1; object < rest.objects.size(); ++object) {
      const Pose* pose = pose_in(window.world.animation, object, window.frames[slot]);
      rest.objects[object].spans.clear();
      if (pose) rest.objects[object].spans.push_back({0, 0, *pose});
    }
    const StaticRays at_rest(window.world.patches, rest);
    for (const Ray& ray : rays) {
      window.rays.all_hits(ray, moving);
      std::erase_if(moving, [&](const MovingHit& h) { return slot < h.first_slot || h.last_slot < slot; });
      at_rest.all_hits(ray, rested);
      ASSERT_EQ(moving.size(), rested.size());
      for (std::size_t k = 0; k < rested.size(); ++k) {
        ASSERT_EQ(moving[k].facet, rested[k].facet);
        ASSERT_EQ(moving[k].distance, rested[k].distance);
        ASSERT_EQ(moving[k].front, rested[k].front);
        ASSERT_EQ(moving[k].u, rested[k].u);
        ASSERT_EQ(moving[k].v, rested[k].v);
      }
      total += rested.size();
    }
  }
  EXPECT_GT(total, static_cast<std::size_t>(ray_count));
}

TEST(MovingRays, EveryFrameIsHitAsIfItsObjectsWereAtRest) {
  expect_as_at_rest(Window(20), 1'000);
}

TEST(MovingRays, AWindowOf128FramesToo) {
  expect_as_at_rest(Window(128), 200);
}

TEST(MovingRays, AWindowOfChosenFramesToo) {
  expect_as_at_rest(Window(3, 120, Window::every(7, 120)), 500);
}

// One query for all slots, and one each for every slot, must agree, also beyond 64 slots.
TEST(MovingRays, TheMaskOfBlockedSlotsIsThatOfOccludedAndOfAllHits) {
  for (const FrameIndex count : {5u, 64u, 65u, 128u}) {
    const Window window(count);
    tests::RandomRays random(2, 13);
    std::vector<MovingHit> hits;
    int touched = 0, partly = 0;
    for (int k = 0; k < 500; ++k) {
      const Ray ray = random.next();
      const SlotMask mask = window.rays.blocked(ray);
      window.rays.all_hits(ray, hits);
      SlotMask of_hits;
      for (const MovingHit& hit : hits) of_hits.set(hit.first_slot, hit.last_slot);
      ASSERT_EQ(mask.bits, of_hits.bits);
      std::uint32_t blocked = 0;
      for (std::uint32_t slot = 0; slot < count; ++slot) {
        ASSERT_EQ(mask.test(slot), window.rays.occluded(ray, slot)) << slot;
        blocked += mask.test(slot) ? 1 : 0;
      }
      for (std::uint32_t slot = count; slot < kWindowMax; ++slot) ASSERT_FALSE(mask.test(slot));
      touched += blocked > 0 ? 1 : 0;
      partly += blocked > 0 && blocked < count ? 1 : 0;
    }
    EXPECT_GT(touched, 50);
    EXPECT_GT(partly, 50);
  }
}

TEST(MovingRays, TheNearestOfASlotIsTheFirstOfAllItsHits) {
  const Window window(100);
  tests::RandomRays random(2, 17);
  std::vector<MovingHit> hits;
  int compared = 0;
  for (int k = 0; k < 500; ++k) {
    const Ray ray = random.next();
    window.rays.all_hits(ray, hits);
    for (std::uint32_t slot = 0; slot < 100; slot += 9) {
      const auto first = std::find_if(hits.begin(), hits.end(), [&](const MovingHit& hit) {
        return hit.first_slot <= slot && slot <= hit.last_slot;
      });
      SurfaceHit nearest;
      ASSERT_EQ(window.rays.nearest(ray, slot, nearest), first != hits.end());
      if (first == hits.end()) continue;
      ASSERT_EQ(nearest.facet, first->facet);
      ASSERT_EQ(nearest.distance, first->distance);
      ASSERT_EQ(nearest.front, first->front);
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
}

// Two faces in one plane, of objects 0 and 1 or of one object, that share an edge on x = 0.
Scene two_faces(std::uint32_t object_of_second) {
  Scene scene = tests::scene_with(1 + object_of_second, 1);
  tests::add_polygon(scene, {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}}, 0);
  tests::add_polygon(scene, {{0, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 1, 0}}, object_of_second);
  return scene;
}

// Rays exactly through the edge cross the surface once in every slot in which there is one.
void expect_edge_crossed_once(const Scene& scene, const Animation& animation) {
  const World world(scene, animation, 1.0);
  const MovingRays rays(world.patches, animation, world.all_frames());
  std::vector<MovingHit> hits;
  for (const float y : {-0.75f, -0.5f, -0.3f, 0.0f, 0.25f, 0.3f, 0.8f})
    for (const float x : {0.0f, 0.5f}) {
      rays.all_hits({{x, y, 2}, {-0.5f * x, 0, -1}}, hits);
      for (std::uint32_t slot = 0; slot < animation.frame_count; ++slot) {
        const auto count = std::count_if(hits.begin(), hits.end(), [&](const MovingHit& hit) {
          return hit.first_slot <= slot && slot <= hit.last_slot;
        });
        const bool is_there =
            pose_in(animation, 0, slot) || pose_in(animation, scene.polygons[1].object, slot);
        EXPECT_EQ(count, is_there ? 1 : 0) << "slot " << slot << " x " << x << " y " << y;
      }
    }
}

TEST(MovingRays, AnEdgeOfTwoObjectsThatComeAndGoIsCrossedOnceInEverySlot) {
  const Scene scene = two_faces(1);
  Animation animation = tests::still(scene, 10);
  animation.objects[0].spans = {{0, 5, {}}};
  animation.objects[1].spans = {{3, 9, {}}};
  expect_edge_crossed_once(scene, animation);
  std::swap(animation.objects[0], animation.objects[1]);
  expect_edge_crossed_once(scene, animation);
  animation.objects[0].spans = {{0, 8, {}}};  // around the other's
  animation.objects[1].spans = {{4, 5, {}}};
  expect_edge_crossed_once(scene, animation);
}

// The poses of a sliding object are met at one distance, in any order.
TEST(MovingRays, AnEdgeWithinAnObjectThatSlidesIsCrossedOnceInEverySlot) {
  const Scene scene = two_faces(0);
  Animation animation = tests::still(scene, 12);
  auto& spans = animation.objects[0].spans;
  spans.clear();
  for (FrameIndex f = 0; f < 12; ++f) spans.push_back({f, f, moved_to(0, 0.01 * f, 0)});
  expect_edge_crossed_once(scene, animation);
}

}  // namespace
}  // namespace engine
