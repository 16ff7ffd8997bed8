#include "engine/direct/window_lights.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::World;

constexpr FrameIndex kFrames = 8;

/// Materials 1 and 2 emit in some frames; object 1, of material 2, moves.
World two_keyed_lights(std::vector<Rgb> first, std::vector<Rgb> second, std::vector<PoseSpan> spans) {
  Scene scene = tests::scene_with(2, 3);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0, 0);
  tests::add_polygon(scene, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, 0, 1);
  tests::add_polygon(scene, {{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}}, 1, 2);
  Animation animation = tests::still(scene, kFrames);
  animation.emission.exitance_w_m2[1] = std::move(first);
  animation.emission.exitance_w_m2[2] = std::move(second);
  animation.objects[1].spans = std::move(spans);
  return World(std::move(scene), std::move(animation), 1);
}

TEST(WindowLights, ALightThatIsOffInTheWholeWindowIsNotInIt) {
  const World world = two_keyed_lights({{}, {}, {}, {}, {1, 0, 0}, {}, {}, {}}, {{0, 2, 0}}, {{0, 7, {}}});
  const auto early = place_window_lights(world.patches, world.animation, std::vector<FrameIndex>{0, 1, 2, 3});
  ASSERT_EQ(early.size(), 1u);
  EXPECT_EQ(early[0].facet, 2u);
  const auto late = place_window_lights(world.patches, world.animation, std::vector<FrameIndex>{3, 4});
  ASSERT_EQ(late.size(), 2u);
  EXPECT_EQ(late[0].facet, 1u);
  EXPECT_FALSE(late[0].lit.test(0));
  EXPECT_TRUE(late[0].lit.test(1));
}

TEST(WindowLights, PosesAreCutToTheSlotsInWhichTheLightShines) {
  const Rgb on{0, 0, 1};
  const World world =
      two_keyed_lights({{}, on, on, {}, on, {}, {}, {}}, {{}, {}, {}, on, on, on, {}, {}},
                       {{0, 2, tests::moved_to(1, 0, 0)}, {3, 4, {}}, {5, 7, tests::moved_to(2, 0, 0)}});
  const auto lights = place_window_lights(world.patches, world.animation, world.all_frames());
  ASSERT_EQ(lights.size(), 2u);
  ASSERT_EQ(lights[0].poses.size(), 1u);
  EXPECT_EQ(lights[0].poses[0].placed.first_slot, 1u);
  EXPECT_EQ(lights[0].poses[0].placed.last_slot, 4u);
  ASSERT_EQ(lights[1].poses.size(), 2u);  // the first pose of the other is dark
  EXPECT_EQ(lights[1].poses[0].placed.first_slot, 3u);
  EXPECT_EQ(lights[1].poses[0].placed.last_slot, 4u);
  EXPECT_EQ(lights[1].poses[1].placed.first_slot, 5u);
  EXPECT_EQ(lights[1].poses[1].placed.last_slot, 5u);
}

TEST(WindowLights, ARangeIsNarrowedToItsLitSlotsAndRefusedWithoutOne) {
  SlotMask lit;
  lit.set(3, 3);
  lit.set(70, 72);
  for (const auto& [from, to, first, last] :
       {std::array{0u, 127u, 3u, 72u}, {4u, 127u, 70u, 72u}, {0u, 69u, 3u, 3u}, {71u, 71u, 71u, 71u}}) {
    std::uint32_t low = from, high = to;
    EXPECT_TRUE(narrow_to_lit(lit, low, high));
    EXPECT_EQ(low, first);
    EXPECT_EQ(high, last);
  }
  for (const auto& [from, to] : {std::array{0u, 2u}, {4u, 69u}, {73u, 127u}, {0u, 0u}}) {
    std::uint32_t low = from, high = to;
    EXPECT_FALSE(narrow_to_lit(lit, low, high));
  }
}

}  // namespace
}  // namespace engine
