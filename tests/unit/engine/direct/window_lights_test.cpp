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

WindowLights place_in(const World& world, const std::vector<FrameIndex>& frames) {
  return place_window_lights(world.patches, world.animation, world.animation.emission, frames);
}

TEST(WindowLights, AMovingLightThatIsOffInTheWholeWindowIsNotInIt) {
  const World world = two_keyed_lights({{}}, {{}, {}, {}, {}, {1, 0, 0}, {}, {}, {}},
                                       {{0, 3, {}}, {4, 7, tests::moved_to(1, 0, 0)}});
  EXPECT_TRUE(place_in(world, {0, 1, 2, 3}).lights.empty());
  const WindowLights late = place_in(world, {3, 4});
  ASSERT_EQ(late.lights.size(), 1u);
  EXPECT_EQ(late.lights[0].facet, 2u);
  const Brightness& brightness = late.brightness.of[late.lights[0].brightness];
  EXPECT_FALSE(brightness.lit.test(0));
  EXPECT_TRUE(brightness.lit.test(1));
}

TEST(WindowLights, ALightAtRestIsInEveryWindowOnceItShinesInSomeFrame) {
  const World world = two_keyed_lights({{}, {}, {}, {}, {1, 0, 4}, {}, {}, {}},
                                       {{}, {}, {}, {}, {}, {}, {}, {}}, {{0, 7, {}}});
  for (const std::vector<FrameIndex>& frames : {std::vector<FrameIndex>{}, {0, 1}, {4}}) {
    const WindowLights lights = place_in(world, frames);
    ASSERT_EQ(lights.static_count, 1u);
    ASSERT_EQ(lights.lights.size(), 1u);
    EXPECT_EQ(lights.lights[0].facet, 1u);
    ASSERT_EQ(lights.lights[0].poses.size(), 1u);
    EXPECT_EQ(lights.lights[0].poses[0].slots.end, frames.size());
    const Brightness& brightness = lights.brightness.of[lights.lights[0].brightness];
    EXPECT_EQ(brightness.peak, 4);
    EXPECT_EQ(brightness.mean, (Rgb{0.125f, 0, 0.5f}));
  }
}

TEST(WindowLights, PosesOfMovingLightsAreCutToTheSlotsInWhichTheyShine) {
  const Rgb on{0, 0, 1};
  const World world =
      two_keyed_lights({{}}, {{}, {}, {}, on, on, on, {}, {}},
                       {{0, 2, tests::moved_to(1, 0, 0)}, {3, 4, {}}, {5, 7, tests::moved_to(2, 0, 0)}});
  const WindowLights lights = place_in(world, world.all_frames());
  ASSERT_EQ(lights.lights.size(), 1u);
  const auto& poses = lights.lights[0].poses;
  ASSERT_EQ(poses.size(), 2u);  // the first is dark
  EXPECT_EQ(poses[0].slots.begin, 3u);
  EXPECT_EQ(poses[0].slots.end, 5u);
  EXPECT_EQ(poses[1].slots.begin, 5u);
  EXPECT_EQ(poses[1].slots.end, 6u);
}

TEST(WindowLights, ASourceHasAPosePerPlaceAndNoneWhereItIsDark) {
  World world = two_keyed_lights({{}}, {{}}, {{0, 7, {}}});
  const Vec3 a{1, 0, 0}, b{2, 0, 0};
  const Rgb on{1, 1, 1};
  Emission emission;
  emission.exitance_w_m2 = world.animation.emission.exitance_w_m2;
  emission.sources.push_back(
      {"moves", api::LightType::point, {a, a, b, b, b, a, a, a}, {{}}, {on, on, on, {}, on, on, {}, on}});
  emission.sources.push_back({"rests", api::LightType::point, {a}, {{}}, {on}});
  emission.sources.push_back({"dark", api::LightType::point, {a}, {{}}, {{}}});
  const WindowLights lights =
      place_window_lights(world.patches, world.animation, emission, world.all_frames());
  ASSERT_EQ(lights.lights.size(), 2u);
  ASSERT_EQ(lights.static_count, 1u);
  EXPECT_EQ(lights.lights[0].poses[0].source, &emission.sources[1]);
  std::vector<std::array<std::uint32_t, 2>> slots;
  for (const LightPose& pose : lights.lights[1].poses) slots.push_back({pose.slots.begin, pose.slots.end});
  const std::vector<std::array<std::uint32_t, 2>> expected{{0, 2}, {2, 3}, {4, 5}, {5, 6}, {7, 8}};
  EXPECT_EQ(slots, expected);
}

TEST(WindowLights, SlotsAreNarrowedToTheLitOnes) {
  SlotMask lit;
  lit.set(3, 3);
  lit.set(70, 72);
  for (const auto& [from, to, first, end] :
       {std::array{0u, 128u, 3u, 73u}, {4u, 128u, 70u, 73u}, {0u, 70u, 3u, 4u}, {71u, 72u, 71u, 72u}}) {
    const Slots narrow = narrow_to_lit(lit, {from, to});
    EXPECT_EQ(narrow.begin, first);
    EXPECT_EQ(narrow.end, end);
  }
  for (const Slots dark : {Slots{0, 3}, Slots{4, 70}, Slots{73, 128}, Slots{0, 1}, Slots{5, 5}})
    EXPECT_TRUE(narrow_to_lit(lit, dark).empty());
}

}  // namespace
}  // namespace engine
