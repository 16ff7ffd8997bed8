#include "engine/visibility/convex_solids.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/visibility/occluders.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::World;

std::vector<std::uint32_t> solids_of(const Scene& scene) {
  return find_convex_solids(mesh_into_patches(scene, 10)->facets);
}

TEST(ConvexSolids, ABoxIsOneAndARoomIsNot) {
  Scene scene = tests::scene_with(2, 1);
  tests::add_box(scene, {0, 0, 0}, {1, 1, 1}, false);
  tests::add_box(scene, {-5, -5, -5}, {5, 5, 5}, true);  // seen from inside
  tests::add_box(scene, {2, 0, 0}, {3, 1, 1}, false, 1);
  const auto solids = solids_of(scene);
  ASSERT_EQ(solids.size(), 18u);
  const std::set<std::uint32_t> first(solids.begin(), solids.begin() + 6);
  const std::set<std::uint32_t> room(solids.begin() + 6, solids.begin() + 12);
  const std::set<std::uint32_t> third(solids.begin() + 12, solids.end());
  EXPECT_EQ(first.size(), 1u);
  EXPECT_EQ(third.size(), 1u);
  EXPECT_NE(*first.begin(), *third.begin());
  EXPECT_FALSE(first.contains(kNoSolid));
  EXPECT_FALSE(third.contains(kNoSolid));
  EXPECT_EQ(room, std::set{kNoSolid});
}

TEST(ConvexSolids, ABoxWithAHoleOrADentIsNone) {
  Scene open = tests::scene_with(1, 1);
  tests::add_box(open, {0, 0, 0}, {1, 1, 1}, false);
  open.polygons.pop_back();
  for (const std::uint32_t solid : solids_of(open)) EXPECT_EQ(solid, kNoSolid);
  Scene two = tests::scene_with(1, 1);  // two boxes that share an edge: closed, but not convex
  tests::add_box(two, {0, 0, 0}, {1, 1, 1}, false);
  tests::add_box(two, {1, 1, 0}, {2, 2, 1}, false);
  for (const std::uint32_t solid : solids_of(two)) EXPECT_EQ(solid, kNoSolid);
}

// What is left out because it is only entered does not let any ray pass.
TEST(ConvexSolids, StopTheRaysThatTheTreeSaysAreStoppedThoughOnlyHalfOfThemIsLookedAt) {
  const World room(tests::room_with_things(), tests::things_move(tests::room_with_things(), 12), 1.0);
  const MovingOccluders moving(room.patches, room.animation, room.all_frames());
  const MovingRays rays(room.patches, room.animation, room.all_frames());
  const OccluderSource source{StaticOccluders(room.patches, room.animation), moving, 1000, 0, 12};
  tests::RandomRays random(2, 9);
  std::size_t looked_at = 0, stopped = 0;
  for (int k = 0; k < 4000; ++k) {
    const Ray ray = random.next();
    const Vec3 end = ray.origin + ray.direction;
    const ShaftEnd from{{ray.origin}, 1, {}, 1e-5f}, to{{end}, 1, {}, 1e-5f};
    ShaftContents contents;
    collect(source, Shaft(from, to), contents);
    RayLanes lanes{};
    lanes.set(0, ray);
    SlotMask mask;
    for (const Occluder* facet : contents.moving)
      if ((crossed_by(*facet, lanes) & 1) != 0) {
        mask.set(facet->first_slot, facet->last_slot);
        ++looked_at;
      }
    ASSERT_EQ(mask.bits, rays.blocked(ray).bits) << k;
    for (std::uint32_t slot = 0; slot < 12; ++slot) stopped += mask.test(slot) ? 1 : 0;
  }
  EXPECT_GT(stopped, 200u);
  EXPECT_LT(looked_at, 1.3 * static_cast<double>(stopped));  // both sides of every box would be almost twice
}

}  // namespace
}  // namespace engine
