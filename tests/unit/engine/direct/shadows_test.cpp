// Shadows from lists of facets and from trees are the same, alone and in windows.
#include "engine/direct/shadows.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/direct/lighting_runs.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::light_directly;
using tests::World;

constexpr FrameIndex kFrames = 9;

/// The moving room under a lamp, and far away an object of `boxes` small boxes that moves too.
World lit_room(int boxes) {
  Scene scene = tests::room_with_things(false);
  scene.objects.emplace_back();
  scene.materials.push_back({"lamp", {}, {}, false});
  tests::add_polygon(
      scene, {{-0.4f, -0.3f, 1.9f}, {-0.4f, 0.3f, 1.9f}, {0.4f, 0.3f, 1.9f}, {0.4f, -0.3f, 1.9f}}, 0, 1);
  for (int b = 0; b < boxes; ++b) {
    const float x = 20 + 0.06f * static_cast<float>(b);
    tests::add_box(scene, {x, 0, 0}, {x + 0.05f, 0.05f, 0.05f}, false, 3);
  }
  Animation animation = tests::things_move(scene, kFrames);
  animation.emission.exitance_w_m2 = {{{}}, {{10, 8, 5}}};
  animation.objects[3].spans.clear();
  for (FrameIndex f = 0; f < kFrames; ++f)
    animation.objects[3].spans.push_back({f, f, tests::moved_to(f, 0, 0)});
  return World(std::move(scene), std::move(animation), 0.5);
}

// 200 boxes have more facets than one object may have that is listed.
TEST(Shadows, AreTheSameWhetherFacetsAreListedOrLeftToTrees) {
  const World few = lit_room(0);
  const DirectLight listed = light_directly(few, few.all_frames());
  EXPECT_GT(listed.counts.shadow_rays, 1000u);
  for (const int boxes : {12, 200}) {
    const World many = lit_room(boxes);
    const DirectLight asked = light_directly(many, many.all_frames());
    EXPECT_GE(asked.counts.shadow_rays, listed.counts.shadow_rays);
    for (PatchId patch = 0; patch < few.patches.count(); ++patch)
      for (FrameIndex f = 0; f < kFrames; ++f)
        ASSERT_EQ(asked.irradiance_w_m2.at(patch, f), listed.irradiance_w_m2.at(patch, f))
            << patch << " " << f;
  }
}

TEST(Shadows, OfAFrameAloneAreThoseInAWindowWhereTreesAreAsked) {
  for (const int boxes : {12, 200}) {
    const World world = lit_room(boxes);
    const DirectLight all = light_directly(world, world.all_frames());
    for (const FrameIndex frame : {0u, 3u, 8u}) {
      const DirectLight alone = light_directly(world, {frame});
      for (PatchId patch = 0; patch < world.patches.count(); ++patch)
        ASSERT_EQ(alone.irradiance_w_m2.at(patch, 0), all.irradiance_w_m2.at(patch, frame)) << patch;
    }
  }
}

/// Rays straight down from z = 1 over x = 0, 1, 2, ..
Ray down_at(float x) {
  return {{x, 0, 1}, {0, 0, -1}, 0.0f, 1.0f};
}

Occluder square_at(float x, std::uint32_t first_slot, std::uint32_t last_slot) {
  PlacedFacet facet;
  facet.origin = {x - 0.4f, -0.5f, 0.5f};
  facet.edge_u = {0.8f, 0, 0};
  facet.edge_v = {0, 1, 0};
  facet.normal = {0, 0, 1};
  const Vec3 o = facet.origin, u = facet.edge_u, v = facet.edge_v;
  facet.corners = {o, o + u, o + u + v, o + v};
  Occluder occluder(facet, false);
  occluder.first_slot = first_slot;
  occluder.last_slot = last_slot;
  return occluder;
}

// More rays than a block has, a last block that is not full, fewer rays after more, slots not from 0 on.
TEST(Shadows, FallOnTheRaysThatWereSetInTheSlotsAskedFor) {
  const World world = lit_room(0);
  Shadows shadows(world.static_rays, nullptr);
  const Occluder at_rest = square_at(2, 0, 0), moving = square_at(17, 3, 6), both = square_at(2, 0, 9);
  for (const std::size_t count : {40u, 19u}) {
    shadows.contents.clear();
    shadows.contents.at_rest = {&at_rest};
    shadows.contents.moving = {&moving, &both};
    shadows.begin(count);
    for (std::size_t k = 0; k < count; ++k)
      if (k != 18) shadows.set(k, down_at(static_cast<float>(k)));
    shadows.cast({2, 6});
    std::vector<std::pair<std::size_t, std::uint32_t>> blocked;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t block = k / RayLanes::kCount, lane = k % RayLanes::kCount;
      EXPECT_EQ((shadows.is_set(block) >> lane) & 1, k == 18 ? 0u : 1u) << k;
      EXPECT_EQ((shadows.at_rest(block) >> lane) & 1, k == 2 ? 1u : 0u) << k;
      EXPECT_EQ(shadows.any_moving(block), block == 1) << k;
      const Slots touched = shadows.touched();
      EXPECT_TRUE(touched.begin >= 2 && touched.end <= 6);
      for (std::uint32_t slot = touched.begin; slot < touched.end; ++slot)
        if (((shadows.moving(block)[slot] >> lane) & 1) != 0) blocked.emplace_back(k, slot);
    }
    EXPECT_EQ(blocked, (std::vector<std::pair<std::size_t, std::uint32_t>>{{17, 3}, {17, 4}, {17, 5}}));
  }
}

}  // namespace
}  // namespace engine
