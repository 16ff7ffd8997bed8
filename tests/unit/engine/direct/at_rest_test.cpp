// The light of the scene at rest, parts of the emission, and ranges of patches.
#include "engine/base/parallel.h"
#include "tests/unit/engine/direct/lighting_runs.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::add_level;
using tests::light_directly;
using tests::World;

/// Materials: 0 paint, 1 and 2 lights. Object 0 rests: floor, a light of each material; object 1 has a light
/// of material 2 and moves; object 2 is a card that comes and goes. A point light rests, another moves.
World changing_world(FrameIndex frames = 4) {
  Scene scene = tests::scene_with(3, 3);
  add_level(scene, {0, 0, 0}, 0.5f, 0.5f, false);
  add_level(scene, {-0.5f, 0, 2}, 0.3f, 0.3f, true, 0, 1);
  add_level(scene, {0.5f, 0, 2}, 0.3f, 0.3f, true, 0, 2);
  add_level(scene, {0, 0.6f, 1.5f}, 0.2f, 0.2f, true, 1, 2);
  add_level(scene, {0, 0, 1}, 0.3f, 2, true, 2, 0);
  Animation animation = tests::still(scene, frames);
  animation.emission.exitance_w_m2[1] = {{8, 4, 2}};
  animation.emission.exitance_w_m2[2].assign(frames, Rgb{});
  animation.emission.exitance_w_m2[2][1] = {4, 8, 16};
  animation.emission.exitance_w_m2[2][frames - 1] = {4, 0, 0};
  animation.objects[1].spans.clear();
  for (FrameIndex f = 0; f < frames; ++f)
    animation.objects[1].spans.push_back({f, f, tests::moved_to(0.01 * f, 0, 0)});
  animation.objects[2].spans = {{1, 1, {}}};
  const auto point = [](std::vector<Vec3> positions) {
    return SourceMotion{"", api::LightType::point, std::move(positions), {{0, 0, -1}}, {{1, 1, 1}}, 1, 0};
  };
  animation.emission.sources = {point({{0.2f, 0, 1.5f}}), point({})};
  for (FrameIndex f = 0; f < frames; ++f)
    animation.emission.sources[1].position.push_back({0.1f * static_cast<float>(f), 0, 1.2f});
  return World(std::move(scene), std::move(animation), 0.5);
}

TEST(AtRest, IsTheSceneWithoutWhatMovesUnderTheMeanOfTheEmission) {
  const World world = changing_world();
  const DirectLight lit = light_directly(world, world.all_frames());

  Animation rest = world.animation;
  rest.objects[1].spans.clear();
  rest.objects[2].spans.clear();
  rest.emission.exitance_w_m2[2] = {{2, 2, 4}};
  rest.emission.sources.pop_back();
  const World resting(world.scene, rest, 0.5);
  const DirectLight expected = light_directly(resting, {0});
  for (PatchId patch = 0; patch < world.patches.count(); ++patch) {
    const Rgb got = lit.at_rest_w_m2[patch], want = expected.irradiance_w_m2.at(patch, 0);
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(tests::channel(got, c), tests::channel(want, c), 1e-6 * (1 + max_channel(want))) << patch;
  }
  EXPECT_GT(lit.at_rest_w_m2[0].r, 0);
  EXPECT_NE(lit.at_rest_w_m2[0], lit.irradiance_w_m2.at(0, 1));  // the card and the lights that move
}

TEST(AtRest, PatchesThatMoveGetNothing) {
  const World world = changing_world();
  const DirectLight lit = light_directly(world, world.all_frames());
  std::size_t moving = 0;
  for (PatchId patch = 0; patch < world.patches.count(); ++patch) {
    const std::uint32_t object = world.patches.facets[world.patches.facet_of[patch]].object;
    if (object == 0) continue;
    EXPECT_EQ(lit.at_rest_w_m2[patch], Rgb{});
    ++moving;
  }
  EXPECT_GT(moving, 0u);
}

TEST(AtRest, DoesNotDependOnTheFramesAskedFor) {
  const World world = changing_world(200);
  const std::vector<Rgb> all = light_directly(world, world.all_frames()).at_rest_w_m2;
  EXPECT_GT(all[0].r, 0);
  for (const std::vector<FrameIndex>& frames : {std::vector<FrameIndex>{}, {0}, {1, 199}, {7, 8, 9}})
    EXPECT_EQ(light_directly(world, frames).at_rest_w_m2, all);
}

TEST(DirectLighter, RangesOneAfterTheOtherGiveWhatAllPatchesGiveAtOnce) {
  const World world = changing_world(150);  // two windows
  const auto frames = world.all_frames();
  const DirectOptions options{8, 4, 5};
  const DirectLight whole = light_directly(world, frames, options);
  const DirectLighter lighter(world.patches, world.animation, world.animation.emission, world.static_rays,
                              frames, options);
  DirectLight parts = lighter.empty();
  for (const auto& [first, end] : {std::array<PatchId, 2>{5, world.patches.count()}, {0, 1}, {1, 5}}) {
    const DirectLight before = parts;
    ASSERT_TRUE(lighter.light(first, end, parts, {}));
    for (PatchId patch = 0; patch < world.patches.count(); ++patch) {
      if (patch >= first && patch < end) continue;
      ASSERT_EQ(parts.irradiance_w_m2.at(patch, 1), before.irradiance_w_m2.at(patch, 1)) << patch;
    }
  }
  EXPECT_EQ(parts.irradiance_w_m2.values, whole.irradiance_w_m2.values);
  EXPECT_EQ(parts.variance.values, whole.variance.values);
  EXPECT_EQ(parts.at_rest_w_m2, whole.at_rest_w_m2);
  EXPECT_EQ(parts.counts.light_samples, whole.counts.light_samples);
  EXPECT_GT(whole.counts.light_samples, 0u);
}

TEST(DirectLighter, AnEmptyRangeIsNothing) {
  const World world = changing_world();
  const auto frames = world.all_frames();
  const DirectLighter lighter(world.patches, world.animation, world.animation.emission, world.static_rays,
                              frames, {});
  DirectLight lit = lighter.empty();
  ASSERT_TRUE(lighter.light(3, 3, lit, {}));
  EXPECT_EQ(lit.counts.light_samples, 0u);
}

// Few lights: each keeps its own rays whatever else shines, so parts add up but for rounding.
TEST(DirectLight, PartsOfTheEmissionAddUpToTheWhole) {
  const World world = changing_world();
  const Emission& whole = world.animation.emission;
  Emission facets = whole, sources = whole;
  facets.sources[0].intensity = facets.sources[1].intensity = {{}};
  for (auto& series : sources.exitance_w_m2) series = {{}};
  const auto frames = world.all_frames();
  const DirectLight all = light_directly(world, whole, frames), a = light_directly(world, facets, frames),
                    b = light_directly(world, sources, frames);
  for (std::size_t k = 0; k < all.irradiance_w_m2.values.size(); ++k) {
    const Rgb sum = a.irradiance_w_m2.values[k] + b.irradiance_w_m2.values[k];
    EXPECT_NEAR(sum.r, all.irradiance_w_m2.values[k].r, 1e-5 * (1 + sum.r)) << k;
  }
  for (std::size_t p = 0; p < all.at_rest_w_m2.size(); ++p)
    EXPECT_NEAR(a.at_rest_w_m2[p].g + b.at_rest_w_m2[p].g, all.at_rest_w_m2[p].g, 1e-5) << p;
  EXPECT_EQ(all.counts.light_samples, a.counts.light_samples + b.counts.light_samples);
}

}  // namespace
}  // namespace engine
