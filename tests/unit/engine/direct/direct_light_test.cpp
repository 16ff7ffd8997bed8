#include "engine/direct/direct_light.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>

#include "engine/base/parallel.h"
#include "tests/unit/engine/direct/penumbra.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::add_blocker;
using tests::add_polygon;
using tests::floor_and_light;
using tests::kExitance;
using tests::kFloor;
using tests::lit_from_above;
using tests::mean_visible_factor;
using tests::moved_to;
using tests::World;

PatchSeries light_up(const World& world, std::vector<FrameIndex> frames, DirectOptions options = {}) {
  auto direct = direct_light(world.patches, world.animation, world.animation.emission, world.static_rays,
                             frames, options, Progress{});
  EXPECT_TRUE(direct);
  return std::move(direct->irradiance_w_m2);
}

// F varies by less than 10 % over the patch: a standard deviation below 0.05 F, 64 samples, 5 standard
// errors.
TEST(DirectLight, AnUnblockedLightGivesExitanceTimesFormFactor) {
  const Scene scene = floor_and_light();
  const World world(scene, lit_from_above(scene, 1), 10);
  const Rgb lit = light_up(world, {0}, {64}).at(kFloor, 0);
  const double factor = mean_visible_factor(9);
  EXPECT_GT(factor, 0.05);
  EXPECT_NEAR(lit.r, kExitance.r * factor, 5 * 0.05 * kExitance.r * factor / 8);
  EXPECT_FLOAT_EQ(lit.g, lit.r / 2);
  EXPECT_FLOAT_EQ(lit.b, lit.r / 10);
}

TEST(DirectLight, BehindAFullBlockerItIsExactlyDark) {
  Scene scene = floor_and_light();
  add_blocker(scene, -9);
  const World world(scene, lit_from_above(scene, 1), 10);
  EXPECT_EQ(light_up(world, {0}).at(kFloor, 0), Rgb{});
}

TEST(DirectLight, AMovingBlockerDarkensItsFramesAndLeavesTheOthersBitForBit) {
  Scene scene = floor_and_light();
  add_blocker(scene, -9);
  Animation animation = lit_from_above(scene, 8);
  const World without(floor_and_light(), lit_from_above(floor_and_light(), 8), 10);
  const Rgb unblocked = light_up(without, {0}).at(kFloor, 0);
  animation.objects[1].spans = {{2, 3, {}}, {4, 4, moved_to(0, 0, 5)}, {6, 6, moved_to(0, 0, 0.5)}};
  const World world(scene, animation, 10);
  const PatchSeries lit = light_up(world, world.all_frames());
  for (FrameIndex frame = 0; frame < 8; ++frame) {
    const bool dark = frame == 2 || frame == 3 || frame == 6;  // in frame 4 it is above the light
    EXPECT_EQ(lit.at(kFloor, frame), dark ? Rgb{} : unblocked) << frame;
  }
}

// The same rays, so the same light but for the rounding of a difference of sums.
TEST(DirectLight, AMovingBlockerTakesAwayWhatItWouldAtRest) {
  for (const float low : {-0.1f, 0.1f}) {
    Scene scene = floor_and_light();
    add_blocker(scene, low);
    const Rgb at_rest = light_up(World(scene, lit_from_above(scene, 3), 10), {1}).at(kFloor, 0);
    Animation animation = lit_from_above(scene, 3);
    animation.objects[1].spans = {{1, 1, {}}};
    const PatchSeries lit = light_up(World(scene, animation, 10), {0, 1, 2});
    EXPECT_GT(at_rest.r, 0);
    EXPECT_LT(at_rest.r, 0.9f * lit.at(kFloor, 0).r);
    EXPECT_NEAR(lit.at(kFloor, 1).r, at_rest.r, 1e-6 * lit.at(kFloor, 0).r) << low;
  }
}

TEST(DirectLight, TwoMovingBlockersThatCoverOneAnotherTakeTheirLightOnce) {
  Scene scene = floor_and_light();
  add_blocker(scene, 0);
  Animation one = lit_from_above(scene, 2);
  one.objects[1].spans = {{0, 0, {}}};
  const Rgb behind_one = light_up(World(scene, one, 10), {0, 1}).at(kFloor, 0);
  scene.objects.resize(3);
  add_polygon(scene, {{0, -9, 1.0001f}, {9, -9, 1.0001f}, {9, 9, 1.0001f}, {0, 9, 1.0001f}}, 2);
  Animation two = lit_from_above(scene, 2);
  two.objects[1].spans = two.objects[2].spans = {{0, 0, {}}};
  const Rgb behind_two = light_up(World(scene, two, 10), {0, 1}).at(kFloor, 0);
  EXPECT_GT(behind_one.r, 0);
  EXPECT_NEAR(behind_two.r, behind_one.r,
              1e-3 * behind_one.r);  // its edge casts the same shadow but for 0.1 mm
}

TEST(DirectLight, AKeyedLightShinesInEachFrameWithThatFramesExitance) {
  const Scene scene = floor_and_light();
  Animation animation = lit_from_above(scene, 4);
  animation.emission.exitance_w_m2[1] = {{1, 2, 4}, {}, {0, 0, 8}, {4, 8, 16}};
  const PatchSeries lit = light_up(World(scene, animation, 10), {0, 1, 2, 3});
  const Rgb at_first = lit.at(kFloor, 0);
  EXPECT_GT(at_first.r, 0);
  EXPECT_EQ(lit.at(kFloor, 1), Rgb{});
  EXPECT_EQ(lit.at(kFloor, 2), (Rgb{0, 0, 2 * at_first.b}));
  EXPECT_EQ(lit.at(kFloor, 3), at_first * 4.0f);
}

TEST(DirectLight, TheBackOfALightIsDark) {
  Scene scene = floor_and_light();
  Animation animation = lit_from_above(scene, 1);
  // A patch above the light that looks down on its back, and one beside it that looks the same way as it.
  add_polygon(scene, {{0, 1, 3}, {1, 1, 3}, {1, 0, 3}, {0, 0, 3}});
  add_polygon(scene, {{2, 1, 1}, {3, 1, 1}, {3, 0, 1}, {2, 0, 1}});
  const World world(scene, animation, 10);
  const PatchSeries lit = light_up(world, {0});
  EXPECT_EQ(lit.at(1, 0), Rgb{});  // the light itself
  EXPECT_EQ(lit.at(2, 0), Rgb{});
  EXPECT_EQ(lit.at(3, 0), Rgb{});
}

TEST(DirectLight, OnlyTheSideThatFacesTheLightIsLit) {
  for (const bool mirrored : {false, true}) {
    const Scene scene = floor_and_light(true);
    Animation animation = lit_from_above(scene, 1);
    if (mirrored)
      animation.objects[0].spans[0].pose.m[2][2] = -1;  // everything upside down: fronts stay fronts
    const World world(scene, animation, 10);
    ASSERT_EQ(world.patches.count(), 4u);  // floor and light, front and back
    const PatchSeries lit = light_up(world, {0});
    EXPECT_GT(lit.at(0, 0).r, 0) << mirrored;
    EXPECT_EQ(lit.at(1, 0), Rgb{}) << mirrored;
  }
}

TEST(DirectLight, ALightThatMovesAwayShinesLess) {
  Scene scene = floor_and_light();
  scene.polygons[1].object = 1;
  Animation animation = lit_from_above(scene, 3);
  animation.objects[1].spans = {{0, 0, {}}, {1, 1, moved_to(0, 0, 2)}};
  const PatchSeries lit = light_up(World(scene, animation, 10), {0, 1, 2});
  EXPECT_GT(lit.at(kFloor, 0).r, 2 * lit.at(kFloor, 1).r);
  EXPECT_GT(lit.at(kFloor, 1).r, 0);
  EXPECT_EQ(lit.at(kFloor, 2), Rgb{});  // gone
}

TEST(DirectLight, PatchesOfAnObjectThatIsNotThereGetNothing) {
  Scene scene = floor_and_light();
  scene.polygons[0].object = 1;
  Animation animation = lit_from_above(scene, 3);
  animation.objects[1].spans = {{1, 1, {}}};
  const PatchSeries lit = light_up(World(scene, animation, 10), {0, 1, 2});
  EXPECT_EQ(lit.at(kFloor, 0), Rgb{});
  EXPECT_GT(lit.at(kFloor, 1).r, 0);
  EXPECT_EQ(lit.at(kFloor, 2), Rgb{});
}

/// The room of moving things with two lights under its ceiling, one of which is on the thing that moves.
World lit_room(FrameIndex frames) {
  Scene scene = tests::room_with_things();
  scene.materials.push_back({"light", {}, {}, false});
  add_polygon(scene, {{-0.3f, 0.3f, 1.95f}, {0.3f, 0.3f, 1.95f}, {0.3f, -0.3f, 1.95f}, {-0.3f, -0.3f, 1.95f}},
              0, 1);
  add_polygon(scene, {{0, 0.1f, -0.2f}, {0.1f, -0.1f, -0.2f}, {-0.1f, -0.1f, -0.2f}}, 1, 1);
  Animation animation = tests::things_move(scene, frames);
  animation.emission.exitance_w_m2[1] = {kExitance};
  return World(scene, animation, 0.5);
}

TEST(DirectLight, AFrameAloneIsTheFrameInAWindowBitForBit) {
  const World room = lit_room(10);
  const PatchSeries together = light_up(room, room.all_frames());
  for (const FrameIndex frame : {0u, 2u, 3u, 9u}) {
    const PatchSeries alone = light_up(room, {frame});
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      ASSERT_EQ(alone.at(patch, 0), together.at(patch, frame)) << "patch " << patch << " frame " << frame;
  }
  double sum = 0;
  for (const Rgb& lit : together.values) sum += lit.r;
  EXPECT_GT(sum, 10);
}

TEST(DirectLight, SequencesLongerThanAWindowGoOnInTheNext) {
  const World room = lit_room(140);
  const PatchSeries all = light_up(room, room.all_frames(), {1});
  for (const FrameIndex frame : {127u, 128u, 139u}) {
    const PatchSeries alone = light_up(room, {frame}, {1});
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      ASSERT_EQ(alone.at(patch, 0), all.at(patch, frame)) << "patch " << patch << " frame " << frame;
  }
}

TEST(DirectLight, OneThreadAndSeveralGiveTheSameBytes) {
  const World room = lit_room(6);
  set_thread_count(1);
  const PatchSeries one = light_up(room, room.all_frames());
  set_thread_count(2);
  const PatchSeries two = light_up(room, room.all_frames());
  set_thread_count(0);
  EXPECT_EQ(one.values, two.values);
}

TEST(DirectLight, StopsWhenToldTo) {
  const World room = lit_room(6);
  std::atomic<int> asked = 0;
  Progress progress;
  progress.stop_requested = [&] { return ++asked > 5; };
  const auto frames = room.all_frames();
  const auto lit = direct_light(room.patches, room.animation, room.animation.emission, room.static_rays,
                                frames, {8}, progress);
  ASSERT_FALSE(lit);
  EXPECT_EQ(lit.error().fault, api::Fault::stopped);
}

}  // namespace
}  // namespace engine
