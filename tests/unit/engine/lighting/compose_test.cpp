#include "engine/lighting/compose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::MovingRoom;

bool is_there(const MovingRoom& room, PatchId patch, FrameIndex frame) {
  return room.patches.facets[room.patches.facet_of[patch]].object != 2 || frame == 2 || frame == 3;
}

PatchSeries uniform(const MovingRoom& room, std::uint32_t columns, Rgb value) {
  PatchSeries series(room.patches.count(), columns);
  std::fill(series.values.begin(), series.values.end(), value);
  return series;
}

/// Two groups of a room that reflects a half: one glows steadily, one is twice as bright in each frame.
struct TwoGroups {
  MovingRoom room{4, 1.0, true};
  LitGroup steady, doubling;
  const LitGroup* both[2] = {&steady, &doubling};
  const std::vector<FrameIndex> frames{1, 3};

  TwoGroups() {
    steady.group = {"a", {{{{1, 0, 0}}}, {}}, {{1, 1, 1}}};
    doubling.group = {"b", {{{{0, 8, 0}}}, {}}, {{0, 0.125f, 0}, {0, 0.25f, 0}, {0, 0.5f, 0}, {0, 1, 0}}};
    steady.direct.irradiance_w_m2 = uniform(room, 2, {3, 0, 0});
    doubling.direct.irradiance_w_m2 = uniform(room, 2, {9, 4, 9});
    steady.direct.variance = uniform(room, 2, {0.09f, 0, 0});
    doubling.direct.variance = uniform(room, 2, {9, 1, 9});
  }
};

TEST(Compose, DirectLightOfGroupsIsAddedWithTheirScales) {
  const TwoGroups lit;
  PatchSeries sum(lit.room.patches.count(), 2);
  add_direct_irradiance(lit.both, lit.frames, sum);
  for (PatchId patch = 0; patch < sum.patch_count; ++patch) {
    ASSERT_EQ(sum.at(patch, 0), (Rgb{3, 1, 0}));
    ASSERT_EQ(sum.at(patch, 1), (Rgb{3, 4, 0}));
  }
}

TEST(Compose, DirectLightOfEveryFrameGivesThoseAskedFor) {
  TwoGroups lit;
  const std::uint32_t every = lit.room.animation.frame_count;
  for (LitGroup* group : {&lit.steady, &lit.doubling}) {
    const DirectLight some = group->direct;
    group->direct.irradiance_w_m2 = group->direct.variance = PatchSeries(lit.room.patches.count(), every);
    for (PatchId patch = 0; patch < lit.room.patches.count(); ++patch)
      for (std::uint32_t k = 0; k < 2; ++k) {
        group->direct.irradiance_w_m2.at(patch, lit.frames[k]) = some.irradiance_w_m2.at(patch, k);
        group->direct.variance.at(patch, lit.frames[k]) = some.variance.at(patch, k);
      }
  }
  const TwoGroups same;
  PatchSeries sum(lit.room.patches.count(), 2), expected = sum, error = sum, expected_error = sum;
  add_direct_irradiance(lit.both, lit.frames, sum);
  add_direct_irradiance(same.both, same.frames, expected);
  to_standard_error(lit.room.lit(), lit.both, lit.frames, error);
  to_standard_error(same.room.lit(), same.both, same.frames, expected_error);
  EXPECT_EQ(sum.values, expected.values);
  EXPECT_EQ(error.values, expected_error.values);
}

TEST(Compose, RadiosityIsExitanceAndWhatIsReflectedWhereAPatchIsThere) {
  const TwoGroups lit;
  PatchSeries radiosity = uniform(lit.room, 2, {2, 0, 6});
  to_radiosity(lit.room.lit(), lit.both, lit.frames, radiosity);
  for (PatchId patch = 0; patch < radiosity.patch_count; ++patch)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const float front = lit.room.patches.is_back(patch) ? 0.0f : 1.0f;  // backs do not emit
      const Rgb expected{front + 1, front * (k == 0 ? 2.0f : 8.0f), 3};
      ASSERT_EQ(radiosity.at(patch, k), is_there(lit.room, patch, lit.frames[k]) ? expected : Rgb{});
    }
}

// rho sqrt(var X + sum scale^2 var H): .5 sqrt(.07 + .09) = .2; .5 sqrt(1/16 or 1).
TEST(Compose, StandardErrorsOfIndependentPartsAddUpInSquares) {
  const TwoGroups lit;
  PatchSeries error = uniform(lit.room, 2, {0.07f, 0, 0.25f});
  to_standard_error(lit.room.lit(), lit.both, lit.frames, error);
  for (PatchId patch = 0; patch < error.patch_count; ++patch)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const Rgb found = error.at(patch, k);
      if (!is_there(lit.room, patch, lit.frames[k])) {
        ASSERT_EQ(found, Rgb{});
        continue;
      }
      ASSERT_NEAR(found.r, 0.2, 1e-6);
      ASSERT_NEAR(found.g, k == 0 ? 0.125 : 0.5, 1e-6);
      ASSERT_NEAR(found.b, 0.25, 1e-6);
    }
}

TEST(Compose, MeanRadiosityIsWeightedByAreaAndLeavesOutWhatEmits) {
  Scene scene = tests::scene_with(1, 2);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  tests::add_polygon(scene, {{2, 0, 0}, {5, 0, 0}, {5, 1, 0}, {2, 1, 0}});
  tests::add_polygon(scene, {{6, 0, 0}, {7, 0, 0}, {7, 1, 0}, {6, 1, 0}}, 0, 1);
  Animation animation = tests::still(scene, 2);
  animation.emission.exitance_w_m2[1] = {{0, 0, 0}, {0, 7, 0}};  // some time is enough
  const tests::World world(scene, animation, 5);
  PatchSeries b(3, 2);
  b.values = {{4, 1, 0}, {0, 2, 0}, {1, 0, 0}, {0, 0, 3}, {100, 0, 0}, {100, 0, 0}};
  EXPECT_NEAR(mean_radiosity(world.lit(), b), (1 * (4 + 2) + 3 * (1 + 3)) / 8.0, 1e-6);
  EXPECT_TRUE(ever_emits(world.lit(), 2));
  EXPECT_FALSE(ever_emits(world.lit(), 1));
}

}  // namespace
}  // namespace engine
