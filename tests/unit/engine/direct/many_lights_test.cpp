// Many lights: right, and at a bounded price.
#include "tests/unit/engine/direct/light_ceiling.h"

namespace engine {
namespace {

using tests::Ceiling;
using tests::channel;
using tests::light_directly;
using tests::Sample;
using tests::World;

constexpr int kSeeds = 24;
constexpr double kFamily = 1e-5;  // false alarms of one ceiling, all patches, frames and channels together

/// [patch of the floor or wall][frame][channel] of the difference between drawing among all lights and
/// lighting with every light's own rays, which few lights of a time get.
void expect_unbiased(const Ceiling& with) {
  const World world = tests::ceiling(with);
  const auto frames = world.all_frames();
  const auto floor = tests::patches_of(world, tests::kPaint);
  const auto parts = tests::one_by_one(world);
  const std::size_t comparisons = floor.size() * (frames.size() + 1) * 3;
  std::vector<Sample> difference(comparisons), light(comparisons);
  const auto add = [&](const DirectLight& lit, double sign, std::vector<double>& to) {
    std::size_t k = 0;
    for (const PatchId patch : floor)
      for (std::size_t frame = 0; frame <= frames.size(); ++frame)
        for (int c = 0; c < 3; ++c)
          to[k++] += sign * channel(frame < frames.size()
                                        ? lit.irradiance_w_m2.at(patch, static_cast<std::uint32_t>(frame))
                                        : lit.at_rest_w_m2[patch],
                                    c);
  };
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    std::vector<double> off(comparisons), whole(comparisons);
    add(light_directly(world, frames, {16, 1, seed}), 1, whole);
    off = whole;
    for (std::size_t p = 0; p < parts.size(); ++p)
      add(light_directly(world, parts[p], frames, {8, 1, 1000 + 100 * seed + p}), -1, off);
    for (std::size_t k = 0; k < comparisons; ++k) {
      difference[k].add(off[k]);
      light[k].add(whole[k]);
    }
  }
  double brightest = 0, error = 0;
  for (std::size_t k = 0; k < comparisons; ++k) {
    EXPECT_TRUE(agrees(difference[k], 0, tests::sidak(kFamily, comparisons), 1e-6 * light[k].mean()))
        << "patch " << floor[k / (3 * (frames.size() + 1))] << " frame " << k / 3 % (frames.size() + 1)
        << " light " << light[k].mean();
    brightest = std::max(brightest, light[k].mean());
    error = std::max(error, difference[k].standard_error());
  }
  EXPECT_LT(error, 0.02 * brightest) << "too noisy to mean anything";
}

TEST(ManyLights, DrawnGiveWhatAllTogetherGive) {
  expect_unbiased({.lights = 160, .materials = 5});
}

TEST(ManyLights, DrawnGiveWhatAllTogetherGivePastACardThatMoves) {
  expect_unbiased({.lights = 160, .materials = 5, .moving_card = true});
}

TEST(ManyLights, DrawnGiveWhatAllTogetherGiveWhereTheyTakeTurns) {
  expect_unbiased({.lights = 160, .materials = 5, .moving_card = true, .take_turns = true});
}

TEST(ManyLights, DrawnGiveWhatAllTogetherGiveWhereSomeMoveAndTakeTurns) {
  expect_unbiased({.lights = 160, .materials = 5, .take_turns = true, .moving_lights = true});
}

TEST(ManyLights, DrawnGiveWhatAllTogetherGiveOnAFloorThatMoves) {
  expect_unbiased({.lights = 160, .materials = 5, .moving_lights = true, .moving_floor = true});
}

TEST(ManyLights, PointAndSpotLightsAreDrawnLikeFacets) {
  World world = tests::ceiling({.lights = 40, .materials = 2});
  auto& emission = world.animation.emission;
  for (int k = 0; k < 60; ++k) {
    const float x = 0.06f * static_cast<float>(k - 30);
    emission.sources.push_back({"",
                                k % 2 == 0 ? api::LightType::point : api::LightType::spot,
                                {{x, -x, 1.1f}},
                                {{0.6f, 0, -0.8f}},
                                {{1, 0.1f * static_cast<float>(k), 3}},
                                0.9,
                                0.7});
  }
  emission.sources.push_back({"", api::LightType::directional, {{}}, {{0, 0.6f, -0.8f}}, {{2, 1, 4}}, 1, 0});
  std::vector<Emission> parts = tests::one_by_one(world);
  for (Emission& part : parts) part.sources.clear();
  for (std::size_t s = 0; s < emission.sources.size(); s += 30) {
    Emission part;
    part.exitance_w_m2.assign(emission.exitance_w_m2.size(), {{}});
    for (std::size_t k = s; k < std::min(s + 30, emission.sources.size()); ++k)
      part.sources.push_back(emission.sources[k]);
    parts.push_back(part);
  }
  for (const PatchId patch : tests::patches_of(world, tests::kPaint)) {
    Sample difference;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      double off = light_directly(world, {0}, {16, 1, seed}).irradiance_w_m2.at(patch, 0).g;
      for (std::size_t p = 0; p < parts.size(); ++p)
        off -= light_directly(world, parts[p], {0}, {16, 1, 1000 + 100 * seed + p})
                   .irradiance_w_m2.at(patch, 0)
                   .g;
      difference.add(off);
    }
    EXPECT_TRUE(agrees(difference, 0, tests::sidak(kFamily, 6), 1e-5)) << patch;
  }
}

TEST(ManyLights, AThousandTakeAtMostFourTimesTheSamplesOfFifteen) {
  const auto samples = [](std::uint32_t lights) {
    const DirectLight lit = light_directly(tests::ceiling({.lights = lights}), {0});
    EXPECT_LE(lit.counts.shadow_rays, lit.counts.light_samples);
    return static_cast<double>(lit.counts.light_samples);
  };
  const double fifteen = samples(15), thousand = samples(1000);
  EXPECT_GT(fifteen, 15 * 16);
  EXPECT_LT(thousand, 4 * fifteen);
  EXPECT_LT(thousand, 1.2 * samples(200));
}

TEST(ManyLights, AFrameAloneIsTheFrameInAWindowBitForBit) {
  const World world = tests::ceiling({.lights = 100, .moving_card = true, .take_turns = true});
  const DirectLight all = light_directly(world, world.all_frames());
  for (const FrameIndex frame : world.all_frames()) {
    const DirectLight alone = light_directly(world, {frame});
    for (PatchId patch = 0; patch < world.patches.count(); ++patch)
      ASSERT_EQ(alone.irradiance_w_m2.at(patch, 0), all.irradiance_w_m2.at(patch, frame)) << patch;
    EXPECT_EQ(alone.at_rest_w_m2, all.at_rest_w_m2);
  }
}

}  // namespace
}  // namespace engine
