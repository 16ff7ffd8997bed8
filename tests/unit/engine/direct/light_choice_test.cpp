#include "engine/direct/light_choice.h"

#include <cmath>
#include <set>

#include "engine/direct/form_factor.h"

#include "tests/unit/engine/direct/light_ceiling.h"

namespace engine {
namespace {

using tests::Ceiling;
using tests::World;

struct Chosen {
  WindowLights lights;
  LightChoice choice;
};

/// A patch where it is in the first frame, in `slots` slots.
Receiver receiver_of(const World& world, PatchId patch, std::uint32_t slots) {
  const std::uint32_t number = world.patches.facet_of[patch];
  const Facet& facet = world.patches.facets[number];
  const Pose& pose = world.animation.objects[facet.object].spans[0].pose;
  Receiver receiver = receiver_facet(facet, number, world.patches.is_back(patch), pose, {0, slots});
  receiver.patch = patch;
  receiver.set_cell(cell_corners(facet, world.patches.cell_of(patch)));
  return receiver;
}

Chosen choose(const World& world, PatchId patch, const std::vector<FrameIndex>& frames = {0, 1, 2, 3}) {
  Chosen chosen;
  chosen.lights = place_window_lights(world.patches, world.animation, world.animation.emission, frames);
  chosen.choice = choose_lights(receiver_of(world, patch, static_cast<std::uint32_t>(frames.size())),
                                chosen.lights.lights, chosen.lights.brightness);
  return chosen;
}

TEST(ChooseLights, FewLightsAllGetTheirOwnRays) {
  for (const std::uint32_t count : {1u, kLightsEachMax}) {
    const Chosen chosen = choose(tests::ceiling({.lights = count}), 0);
    EXPECT_EQ(chosen.choice.each.size(), count);
    EXPECT_TRUE(chosen.choice.drawn.empty());
  }
}

TEST(ChooseLights, OfManyEachThatCanShineOnThePatchIsInOneOfTheTwoWithAPositiveProbability) {
  const World world = tests::ceiling({.lights = 500});
  for (const PatchId patch : tests::patches_of(world, tests::kPaint)) {
    if (world.patches.facet_of[patch] != 0) continue;  // the floor
    const Chosen chosen = choose(world, patch);
    std::set<std::uint32_t> found(chosen.choice.each.begin(), chosen.choice.each.end());
    double sum = 0;
    for (const DrawnLight& drawn : chosen.choice.drawn) {
      EXPECT_TRUE(found.insert(drawn.light).second) << "in both";
      EXPECT_GT(drawn.probability, 0);
      sum += drawn.probability;
    }
    EXPECT_NEAR(sum, 1, 1e-4);
    EXPECT_EQ(found.size(), 500u);
    EXPECT_LE(chosen.choice.shared_lights + static_cast<float>(chosen.choice.each.size()), kLightsEachMax);
  }
}

TEST(ChooseLights, LightsBehindThePatchAreLeftOut) {
  Scene scene = tests::scene_with(1, 2);
  tests::add_level(scene, {0, 0, 0}, 0.5f, 0.5f, false);
  for (int l = 0; l < 100; ++l)  // half of them below the floor
    tests::add_level(scene, {0.1f * static_cast<float>(l), 0, l % 2 == 0 ? 1.0f : -1.0f}, 0.04f, 0.04f, true,
                     0, 1);
  Animation animation = tests::still(scene, 1);
  animation.emission.exitance_w_m2[1] = {{1, 1, 1}};
  const Chosen chosen = choose(World(scene, animation, 10), 0, {0});
  EXPECT_EQ(chosen.choice.each.size() + chosen.choice.drawn.size(), 50u);
}

TEST(ChooseLights, ALightThatOutshinesTheOthersGetsItsOwnRays) {
  World world = tests::ceiling({.lights = 500, .materials = 500});
  world.animation.emission.exitance_w_m2[tests::kFirstLamp + 123] = {{0, 1e6f, 0}};
  const Chosen chosen = choose(world, 0);
  ASSERT_EQ(chosen.choice.each.size(), 1u);
  EXPECT_EQ(chosen.lights.lights[chosen.choice.each[0]].brightness, tests::kFirstLamp + 123);
}

TEST(ChooseLights, ProbabilitiesFollowTheUnoccludedLight) {
  const World world = tests::ceiling({.lights = 1000, .materials = 1});
  const Chosen chosen = choose(world, 0);
  ASSERT_GT(chosen.choice.drawn.size(), 900u);
  const Receiver receiver = receiver_of(world, 0, 1);
  std::vector<double> factors;
  double sum = 0;
  for (const DrawnLight& drawn : chosen.choice.drawn) {
    const PlacedLight& light = chosen.lights.lights[drawn.light].poses[0].facet;
    double factor = 0;
    for (int k = 0; k < 16; ++k)
      factor += point_to_polygon_form_factor(receiver.at((static_cast<float>(k % 4) + 0.5f) / 4,
                                                         (static_cast<float>(k / 4) + 0.5f) / 4),
                                             receiver.placed.normal, light.polygon()) /
                16;
    factors.push_back(factor);
    sum += factor;
  }
  double off = 0;  // half the sum of differences: the probability that is in the wrong place
  for (std::size_t k = 0; k < factors.size(); ++k)
    off += 0.5 * std::abs(factors[k] / sum - chosen.choice.drawn[k].probability);
  EXPECT_LT(off, 0.2) << "a tenth is the defensive part";
}

TEST(ChooseLights, LightsThatTakeTurnsGetMoreRays) {
  const Chosen steady = choose(tests::ceiling({.lights = 500}), 0);
  const Chosen turns = choose(tests::ceiling({.lights = 500, .take_turns = true}), 0);
  EXPECT_FLOAT_EQ(steady.lights.brightness.variety, 1);
  EXPECT_NEAR(turns.lights.brightness.variety, 4, 0.01);  // one of four groups in each frame
  EXPECT_GT(turns.choice.shared_lights, 3 * steady.choice.shared_lights);
}

TEST(ChooseLights, ForAPatchAndLightsAtRestIsTheSameInEveryWindow) {
  const World world = tests::ceiling({.lights = 200, .take_turns = true});
  const Chosen all = choose(world, 0), one = choose(world, 0, {2}), none = choose(world, 0, {});
  ASSERT_FALSE(all.choice.drawn.empty());
  for (const Chosen* other : {&one, &none}) {
    EXPECT_EQ(other->choice.each, all.choice.each);
    ASSERT_EQ(other->choice.drawn.size(), all.choice.drawn.size());
    for (std::size_t k = 0; k < all.choice.drawn.size(); ++k) {
      EXPECT_EQ(other->choice.drawn[k].light, all.choice.drawn[k].light);
      EXPECT_EQ(other->choice.drawn[k].probability, all.choice.drawn[k].probability);
    }
  }
}

}  // namespace
}  // namespace engine
