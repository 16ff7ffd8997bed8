#include "engine/keyframes/jumps.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/keyframes/series.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

Animation squares_at_rest(FrameIndex frames) {
  return tests::still(tests::squares(1), frames);
}

/// One group of everything that the animation emits, with scale 1.
std::vector<LightGroup> all_light(const Animation& animation) {
  return {{"", animation.emission, {Rgb{1, 1, 1}}}};
}

std::vector<Rgb> through(const std::vector<std::pair<std::uint32_t, float>>& knots, Rgb colour) {
  std::vector<Rgb> series;
  for (std::uint32_t f = 0; f <= knots.back().first; ++f)
    series.push_back(colour * tests::through_knots(knots, f));
  return series;
}

/// Jumps where a lamp follows `knots`.
Frames jumps_of_lamp(const std::vector<std::pair<std::uint32_t, float>>& knots, Rgb colour = {0.2f, 1, 0}) {
  Animation animation = squares_at_rest(knots.back().first + 1);
  animation.emission.exitance_w_m2[0] = through(knots, colour);
  return frames_at_jumps(animation, all_light(animation));
}

TEST(FramesAtJumps, OfSteadySeriesAreNone) {
  const Animation animation = squares_at_rest(10);
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), Frames{});
  EXPECT_EQ(jumps_of_lamp({{0, 5}, {9, 5}}), Frames{});
}

TEST(FramesAtJumps, AreBothSidesOfASwitch) {
  EXPECT_EQ(jumps_of_lamp({{0, 0}, {9, 0}, {10, 50}, {20, 50}, {21, 0}, {29, 0}}), (Frames{9, 10, 20, 21}));
  EXPECT_EQ(jumps_of_lamp({{0, 50}, {9, 50}, {10, 20}, {29, 20}}), (Frames{9, 10}));
  EXPECT_EQ(jumps_of_lamp({{0, 0}, {1, 5}, {2, 0}, {9, 0}}), (Frames{0, 1, 2}));  // a flash
}

TEST(FramesAtJumps, AreNotThoseOfALightThatIsDimmedOrCreeps) {
  EXPECT_EQ(jumps_of_lamp({{0, 0}, {29, 50}}), Frames{});
  EXPECT_EQ(jumps_of_lamp({{0, 0}, {9, 0}, {11, 50}, {29, 50}}), Frames{});    // a ramp of two frames
  EXPECT_EQ(jumps_of_lamp({{0, 50}, {9, 50}, {10, 49}, {29, 49}}), Frames{});  // a small step
}

// What a group's scale does is computed in every frame, however it jumps.
TEST(FramesAtJumps, AreNotThoseOfAScale) {
  const Animation animation = squares_at_rest(10);
  auto groups = all_light(animation);
  groups[0].emission.exitance_w_m2[0] = {{50, 50, 50}};
  groups[0].scale = through({{0, 0}, {4, 0}, {5, 1}, {9, 1}}, {1, 1, 1});
  EXPECT_EQ(frames_at_jumps(animation, groups), Frames{});
}

// Emission is that of the groups: what the animation says is divided among them.
TEST(FramesAtJumps, AreThoseOfEveryGroup) {
  Animation animation = squares_at_rest(10);
  auto groups = all_light(animation);
  groups.push_back(groups[0]);
  groups[0].emission.exitance_w_m2[0] = through({{0, 0}, {1, 9}, {9, 9}}, {1, 1, 1});
  groups[1].emission.exitance_w_m2[0] = through({{0, 9}, {5, 9}, {6, 0}, {9, 0}}, {1, 1, 1});
  EXPECT_EQ(frames_at_jumps(animation, groups), (Frames{0, 1, 5, 6}));
}

TEST(FramesAtJumps, AreThoseOfLightsWithoutSurface) {
  Animation animation = squares_at_rest(10);
  SourceMotion bulb;
  bulb.position = {{0, 0, 1}};
  bulb.direction = {{0, 0, -1}};
  bulb.intensity = through({{0, 0}, {3, 0}, {4, 2}, {9, 2}}, {1, 1, 1});
  animation.emission.sources.push_back(bulb);
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), (Frames{3, 4}));
}

TEST(FramesAtJumps, AreThoseOfReflectance) {
  Animation animation = squares_at_rest(10);
  animation.reflectance = {through({{0, 0.1f}, {6, 0.1f}, {7, 0.8f}, {9, 0.8f}}, {1, 0.5f, 0})};
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), (Frames{6, 7}));
  animation.reflectance = {through({{0, 0.1f}, {9, 0.8f}}, {1, 0.5f, 0})};
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), Frames{});
}

// A channel that falls as another rises is a change though the largest channel stays.
TEST(FramesAtJumps, SeeAChangeOfColour) {
  Animation animation = squares_at_rest(4);
  animation.emission.exitance_w_m2[0] = {{5, 0, 0}, {5, 0, 0}, {0, 5, 0}, {0, 5, 0}};
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), (Frames{1, 2}));
}

TEST(FramesAtJumps, AreThoseOfThingsThatComeAndGo) {
  Animation animation = squares_at_rest(30);
  animation.objects[1].spans = {{5, 6, {}}, {7, 11, tests::moved_to(1, 0, 0)}, {20, 29, {}}};
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)),
            (Frames{4, 5, 11, 12, 19, 20}));  // at 7 it only moves
  animation.objects[1].spans = {{0, 28, {}}};
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), (Frames{28, 29}));
  animation.objects[1].spans = {};
  EXPECT_EQ(frames_at_jumps(animation, all_light(animation)), Frames{});
}

}  // namespace
}  // namespace engine
