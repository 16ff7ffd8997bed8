// Facets in a shaft stop the rays that the tree says are stopped, in the same slots.
#include "engine/visibility/occluders.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::World;

World moving_room() {
  Scene scene = tests::room_with_things(false);
  Animation animation = tests::things_move(scene, 12);
  return World(std::move(scene), std::move(animation), 1.0);
}

/// The slots in which facets of the contents stop a ray; `at_rest`: does one at rest?
SlotMask stopped(const ShaftContents& contents, const Ray& ray, bool& at_rest) {
  RayLanes lanes{};
  lanes.set(0, ray);
  at_rest = false;
  for (const Occluder* facet : contents.at_rest) at_rest = at_rest || (crossed_by(*facet, lanes) & 1u) != 0;
  SlotMask mask;
  for (const Occluder* facet : contents.moving)
    if ((crossed_by(*facet, lanes) & 1u) != 0) mask.set(facet->first_slot, facet->last_slot);
  return mask;
}

/// Two squares that face each other along a ray; the ray runs from middle to middle.
Shaft shaft_along(const Ray& ray, float half) {
  const Vec3 axis = normalized(ray.direction);
  const Vec3 s = half * normalized(cross(axis, std::abs(axis.x) < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 t = cross(axis, s);
  const auto square = [&](Vec3 at) { return std::array<Vec3, 4>{at + s, at + t, at - s, at - t}; };
  return Shaft({square(ray.origin), 4, axis, 0}, {square(ray.origin + ray.direction), 4, -axis, 0});
}

TEST(Occluders, StopTheRaysThatTheTreesSayAreStopped) {
  const World room = moving_room();
  const auto frames = room.all_frames();
  const StaticOccluders at_rest(room.patches, room.animation);
  const MovingOccluders moving(room.patches, room.animation, frames);
  const MovingRays rays(room.patches, room.animation, frames);
  tests::RandomRays random(3, 4);
  int rest_count = 0, moving_count = 0;
  for (int k = 0; k < 5000; ++k) {
    const Ray ray = random.next();
    ShaftContents contents;
    at_rest.collect(shaft_along(ray, 0.05f), 1000, contents);
    moving.collect(shaft_along(ray, 0.05f), 0, 11, contents);
    bool rests = false;
    const SlotMask mask = stopped(contents, ray, rests);
    ASSERT_EQ(rests, room.static_rays.occluded(ray)) << k;
    ASSERT_EQ(mask.bits, rays.blocked(ray).bits) << k;
    rest_count += rests ? 1 : 0;
    moving_count += mask.bits[0] != 0 ? 1 : 0;
    for (const std::uint32_t slot : {0u, 7u}) {
      ShaftContents alone;
      moving.collect(shaft_along(ray, 0.05f), slot, slot, alone);
      bool none = false;
      ASSERT_EQ(stopped(alone, ray, none).test(slot), rays.occluded(ray, slot)) << k;
    }
  }
  EXPECT_GT(rest_count, 100);
  EXPECT_GT(moving_count, 100);
}

TEST(Occluders, VeryManyAreNotListed) {
  const World room = moving_room();
  std::uint32_t mover = 0;
  for (const Facet& facet : room.patches.facets)
    if (!room.animation.objects[facet.object].is_static(12)) mover = facet.object;
  ASSERT_NE(mover, 0u);
  const Shaft shaft = shaft_along({{-9, 0, 0}, {18, 0, 0}}, 9);
  // As many copies of every facet of an object: so many that one object has them, or all together.
  for (const int copies : {0, 100, 300}) {
    Patches many = room.patches;
    for (const Facet& facet : room.patches.facets)
      for (int copy = 0; facet.object == mover && copy < copies; ++copy) many.facets.push_back(facet);
    const MovingOccluders moving(many, room.animation, room.all_frames());
    ShaftContents all, one;
    moving.collect(shaft, 0, 11, all);
    moving.collect(shaft, 3, 3, one);
    EXPECT_EQ(all.some_slots_many(), copies == 300);
    EXPECT_EQ(one.some_slots_many(), copies == 300);
    EXPECT_EQ(moving.unlisted(shaft, 0, 11).bits, all.many_moving.bits);
    EXPECT_FALSE(all.none_moving());
    EXPECT_FALSE(one.none_moving());
  }
  ShaftContents at_rest;
  StaticOccluders(room.patches, room.animation).collect(shaft, 2, at_rest);
  EXPECT_TRUE(at_rest.many_at_rest);
}

// A ray in a narrow shaft within a wide one is stopped by what is sifted from the list of the wide one.
TEST(Occluders, SiftedFromAWiderShaftStopTheSameRays) {
  const World room = moving_room();
  const StaticOccluders at_rest(room.patches, room.animation);
  const MovingOccluders moving(room.patches, room.animation, room.all_frames());
  const MovingRays rays(room.patches, room.animation, room.all_frames());
  tests::RandomRays random(3, 5);
  int stopped_count = 0, shorter = 0;
  for (const std::size_t most : {1000u, 3u}) {
    const OccluderSource source{at_rest, moving, most, 0, 12};
    for (int k = 0; k < 2000; ++k) {
      const Ray ray = random.next();
      Candidates wide, narrow;
      collect(source, shaft_along(ray, 0.5f), wide);
      sift(source, wide, shaft_along(ray, 0.2f), narrow);
      ShaftContents contents;
      sift(source, narrow, shaft_along(ray, 0.05f), contents);
      shorter += contents.moving.size() < wide.moving.facets.size() ? 1 : 0;
      bool rests = false;
      const SlotMask mask = stopped(contents, ray, rests);
      ASSERT_EQ(rests || contents.many_at_rest, room.static_rays.occluded(ray) || contents.many_at_rest) << k;
      ASSERT_EQ(mask.bits, rays.blocked(ray).bits) << k;
      stopped_count += mask.bits[0] != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(stopped_count, 100);
  EXPECT_GT(shorter, 100);
}

}  // namespace
}  // namespace engine
