#include "engine/lighting/solve_difference.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <random>

#include "engine/animation/light_groups.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using tests::LitRoom;
using tests::MovingRoom;
using tests::SolvedRoom;

constexpr FrameIndex kFrames = 10;
constexpr LineOptions kFewLines{3'000, 7};

double green(Rgb value) {
  return value.g;
}

/// Irradiance X = T_f B of B = S + rho T_f B by elimination, with the window's lines, green.
std::vector<double> direct_solution(const SolvedRoom& room, FrameIndex frame) {
  const std::uint32_t patches = room.world.patches.count();
  const tests::Dense t = tests::operator_in(room.lines, patches, frame);
  tests::Dense system(patches);
  std::vector<double> source(patches);
  for (PatchId i = 0; i < patches; ++i) {
    source[i] = green(room.source.in_frame(room.lit, i, frame));
    const double rho = green(room.lit.reflectance(i, frame));
    for (PatchId j = 0; j < patches; ++j) system.at(i, j) = (i == j ? 1 : 0) - rho * t.at(i, j);
  }
  return t.times(solve_dense(system, source));
}

/// X_s + D_f of every patch and frame against the direct solution, where the scene at rest has the same lines
/// as the window. Either iteration ends within 1e-5 of the mean of what is carried, and X_s is one step of
/// the iteration behind R_s: with reflectances up to .7 three times that error at most comes from there, with
/// rho as much as `bounces` = 1 / (1 - rho).
void expect_direct_solution(const SolvedRoom& room, double bounces = 3) {
  const DifferenceLight light = room.solve();
  EXPECT_TRUE(light.convergence.converged);
  double mean = 0;
  std::size_t different = 0;
  for (FrameIndex frame = 0; frame < room.frames.size(); ++frame) {
    const std::vector<double> expected = direct_solution(room, frame);
    for (const double value : expected) mean = std::max(mean, value);
    for (PatchId patch = 0; patch < expected.size(); ++patch) {
      const double found = green(room.irradiance(light, patch, frame));
      ASSERT_NEAR(found, expected[patch], (1 + bounces) * kIterationError * std::max(mean, 1.0))
          << patch << " " << frame;
      different += std::abs(green(light.irradiance_w_m2.at(patch, frame))) > 0.01 * mean ? 1 : 0;
    }
  }
  EXPECT_GT(mean, 0.1);
  EXPECT_GT(different, 100u) << "the frames hardly differ from the scene at rest";
}

void expect_direct_solution_of(const std::function<void(LitRoom&)>& change, bool both_sides = false) {
  LitRoom room(kFrames, 1.0, both_sides);
  change(room);
  expect_direct_solution({room, {&room.animation.emission}, kFewLines, kFewLines});
}

TEST(SolveDifference, IsTheDirectSolutionWhereThingsMoveUnderALamp) {
  expect_direct_solution_of([](LitRoom&) {});
}

TEST(SolveDifference, IsTheDirectSolutionWhereSheetsHaveTwoSides) {
  expect_direct_solution_of([](LitRoom&) {}, true);
}

TEST(SolveDifference, IsTheDirectSolutionWhereReflectanceIsKeyed) {
  expect_direct_solution_of([](LitRoom& room) {
    room.animation.reflectance = {{}, {}, {{0.2f, 0.6f, 0.1f}}};
    for (FrameIndex f = 0; f < kFrames; ++f)
      room.animation.reflectance[0].push_back(Rgb{1, 1, 1} * (0.1f + 0.06f * static_cast<float>(f)));
  });
}

/// Irradiance at random, [patch][frame] and at rest.
DirectLight random_direct(const LitRoom& room) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 5);
  DirectLight direct;
  direct.irradiance_w_m2 = PatchSeries(room.patches.count(), kFrames);
  for (Rgb& value : direct.irradiance_w_m2.values)
    value = {uniform(random), uniform(random), uniform(random)};
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    direct.at_rest_w_m2.push_back(Rgb{1, 1, 1} * (room.lit().at_rest(patch) ? uniform(random) : 0.0f));
  return direct;
}

// The groups know the scene at rest alone. Where a frame reflects far less than that their corrections go too
// far, and would grow without end if all of them were taken.
TEST(SolveDifference, IsTheDirectSolutionWhereAFrameReflectsFarLessThanTheSceneAtRest) {
  LitRoom room(kFrames);
  room.animation.reflectance = {{}, {}, {{0.2f, 0.6f, 0.1f}}};
  for (FrameIndex f = 0; f < kFrames; ++f)
    room.animation.reflectance[0].push_back(Rgb{1, 1, 1} * (f == 4 ? 0.4f : 0.9f));
  const SolvedRoom solved(room, {&room.animation.emission}, kFewLines, kFewLines);
  expect_direct_solution(solved, 1 / (1 - 0.9));
  EXPECT_LT(solved.solve().convergence.iterations, 60u);
}

TEST(SolveDifference, IsTheDirectSolutionWhereSomethingDarkTakesMostOfTheLightAway) {
  Scene scene = tests::scene_with(2, 3, false);
  tests::add_box(scene, {-1.5f, -1.25f, 0}, {1.5f, 1.25f, 2}, true);
  tests::add_box(scene, {-1.3f, -1.1f, 0.1f}, {1.3f, 1.1f, 1.7f}, false, 1);
  tests::add_polygon(
      scene, {{-0.4f, -0.3f, 1.9f}, {-0.4f, 0.3f, 1.9f}, {0.4f, 0.3f, 1.9f}, {0.4f, -0.3f, 1.9f}}, 0, 1);
  for (Polygon& polygon : scene.polygons)
    if (polygon.object == 1) polygon.material = 2;
  Animation animation = tests::still(scene, kFrames);
  animation.emission.exitance_w_m2 = {{{}}, {{10, 8, 5}}, {{}}};
  animation.reflectance = {{{0.95f, 0.95f, 0.95f}}, {{0, 0, 0}}, {{0.02f, 0.02f, 0.02f}}};
  animation.objects[1].spans.clear();
  for (FrameIndex f = 0; f < kFrames; ++f)
    animation.objects[1].spans.push_back({f, f, tests::moved_to(0.01 * f, 0, 0)});
  const tests::World room(scene, animation, 0.5);
  const SolvedRoom solved(room, {&room.animation.emission}, {20'000, 7}, {20'000, 7});
  expect_direct_solution(solved, 1 / (1 - 0.95));
  EXPECT_LT(solved.solve().convergence.iterations, 100u);
}

TEST(SolveDifference, SaysSoWhereLightGrowsWithoutEnd) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kFewLines, kFewLines);
  DirectLight direct = random_direct(room);
  direct.irradiance_w_m2.at(0, 3) = {INFINITY, 1, 1};
  const WindowScene window{solved.lit,       solved.frames, solved.lines,
                           solved.transport, solved.rest,   {&room.animation.emission, &direct}};
  const auto light = solve_difference(window, Columns::every(kFrames), Progress{});
  ASSERT_FALSE(light);
  EXPECT_EQ(light.error().fault, api::Fault::internal);
}

TEST(SolveDifference, IsTheDirectSolutionWhereALampIsDimmed) {
  expect_direct_solution_of([](LitRoom& room) {
    room.animation.emission.exitance_w_m2[1].clear();
    for (FrameIndex f = 0; f < kFrames; ++f)
      room.animation.emission.exitance_w_m2[1].push_back(Rgb{1, 1, 1} * static_cast<float>(f % 4));
  });
}

TEST(SolveDifference, IsTheDirectSolutionWhereTheLightMoves) {
  expect_direct_solution_of([](LitRoom& room) {
    room.animation.emission.exitance_w_m2 = {{{}}, {{}}, {{3, 5, 2}}};  // object 1 glows, the lamp is out
  });
}

TEST(SolveDifference, IsTheDirectSolutionWhereAGlowingThingAppears) {
  expect_direct_solution_of([](LitRoom& room) {
    for (Facet& facet : room.patches.facets)
      if (facet.object == 2) facet.material = 2;
    for (Facet& facet : room.patches.facets)
      if (facet.object == 1) facet.material = 0;
    room.animation.emission.exitance_w_m2[2] = {{9, 9, 9}};
  });
}

TEST(SolveDifference, IsTheDirectSolutionOfWhatDirectLightIsReflectedWhateverItIsAtRest) {
  const LitRoom room(kFrames);
  const DirectLight direct = random_direct(room);
  expect_direct_solution({room, {&room.animation.emission, &direct}, kFewLines, kFewLines});
}

TEST(SolveDifference, PositionSaysWhereDirectLightOfAFrameIs) {
  const LitRoom room(kFrames);
  DirectLight direct = random_direct(room);
  const SolvedRoom straight(room, {&room.animation.emission, &direct}, kFewLines, kFewLines);
  const DifferenceLight expected = straight.solve();
  DirectLight reversed = direct;
  std::vector<std::uint32_t> position;
  for (FrameIndex f = 0; f < kFrames; ++f) {
    position.push_back(kFrames - 1 - f);
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      reversed.irradiance_w_m2.at(patch, kFrames - 1 - f) = direct.irradiance_w_m2.at(patch, f);
  }
  const SolvedRoom mirrored(room, {&room.animation.emission, &reversed, position}, kFewLines, kFewLines);
  EXPECT_EQ(mirrored.solve().irradiance_w_m2.values, expected.irradiance_w_m2.values);
}

TEST(SolveDifference, OfAStaticSceneIsExactlyZero) {
  LitRoom room(4);
  for (ObjectMotion& motion : room.animation.objects) motion.spans = {{0, 3, {}}};
  const StaticRays rays(room.patches, room.animation);
  const LitScene lit{room.scene, room.animation, room.patches, rays};
  const GroupSource source[] = {{&room.animation.emission}};
  SolveCounts counts;
  const auto rest = light_at_rest(lit, source, {5'000, 1}, counts, Progress{});
  const auto frames = room.all_frames();
  const auto lines = trace_lines(room.patches, room.animation, rays, frames, {1'000, 1}, Progress{});
  const auto light =
      solve_difference({lit, frames, *lines, RestTransport(lit, *lines), (*rest)[0], source[0]},
                       Columns::every(4), Progress{});
  ASSERT_TRUE(light);
  for (const Rgb value : light->irradiance_w_m2.values) ASSERT_EQ(value, Rgb{});
  for (const Rgb value : light->carried_w_m2.values) ASSERT_EQ(value, Rgb{});
}

// Everything emits E and reflects rho, whatever moves inside: B = E / (1 - rho) with zero variance, also
// where the scene at rest was solved with other lines than the window, and more of them.
TEST(SolveDifference, TheFurnaceIsExactWithLinesOfItsOwn) {
  MovingRoom room(kFrames);
  room.animation.emission.exitance_w_m2[0] = {{1, 2, 4}};
  room.animation.reflectance = {{{0.5f, 0.2f, 0}}};
  const SolvedRoom solved(room, {&room.animation.emission}, {20'000, 1}, {2'000, 8});
  const DifferenceLight light = solved.solve();
  int checked = 0;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (FrameIndex frame = 0; frame < kFrames; ++frame) {
      if (solved.lines.crossings.at(patch, frame) == 0) continue;
      const Rgb irradiance = solved.irradiance(light, patch, frame);
      // Either iteration ends within 1e-5 of the mean of the largest channel.
      ASSERT_NEAR(1 + 0.5f * irradiance.r, 2, 2 * 1e-5 * 4) << patch << " " << frame;
      ASSERT_NEAR(2 + 0.2f * irradiance.g, 2.5, 2 * 1e-5 * 4);
      ASSERT_NEAR(irradiance.b, 4, 2 * 1e-5 * 4);
      ++checked;
    }
  EXPECT_GT(checked, 1000);
}

TEST(SolveDifference, ColumnsOfSomeSlotsAreThoseOfAll) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kFewLines, kFewLines);
  const DifferenceLight all = solved.solve();
  const std::vector<std::uint32_t> slots{1, 2, 8};
  const DifferenceLight some = solved.solve(tests::columns_of(slots, kFrames));
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (std::uint32_t c = 0; c < slots.size(); ++c) {
      ASSERT_NEAR(green(some.irradiance_w_m2.at(patch, c)), green(all.irradiance_w_m2.at(patch, slots[c])),
                  1e-4);
      ASSERT_NEAR(green(some.carried_w_m2.at(patch, c)), green(all.carried_w_m2.at(patch, slots[c])), 1e-4);
    }
}

// The direct light differs from that at rest in every frame, and what of it is sent on once is not in Y.
TEST(SolveDifference, CarriedIsTheStaticTransportOfWhatWasReflectedOnceMore) {
  const LitRoom room(kFrames);
  const DirectLight direct = random_direct(room);
  const SolvedRoom solved(room, {&room.animation.emission, &direct}, kFewLines, kFewLines);
  const DifferenceLight light = solved.solve();
  PatchSeries reflected(room.patches.count(), kFrames);
  for (PatchId patch = 0; patch < reflected.patch_count; ++patch)
    for (FrameIndex f = 0; f < kFrames; ++f)
      reflected.at(patch, f) = solved.lit.reflectance(patch, f) * light.irradiance_w_m2.at(patch, f);
  const SampledOperator sampled(solved.lines);
  double largest = 0;
  for (PatchId patch = 0; patch < reflected.patch_count; ++patch) {
    std::vector<Rgb> carried(kFrames);
    sampled.gather_at_rest(reflected, patch, carried.data());
    for (FrameIndex f = 0; f < kFrames; ++f) {
      ASSERT_NEAR(green(light.carried_w_m2.at(patch, f)), green(carried[f]), 1e-4);
      largest = std::max(largest, std::abs(green(carried[f])));
      if (!solved.lit.at_rest(patch)) {
        ASSERT_EQ(light.carried_w_m2.at(patch, f), Rgb{});
      }
    }
  }
  EXPECT_GT(largest, 0.1);
}

TEST(SolveDifference, GroupsOfLightsAddUpToAllLight) {
  LitRoom room(kFrames);
  room.animation.emission.exitance_w_m2 = {{{0.2f, 0, 0.1f}}, {}, {{0, 1, 2}}};
  for (FrameIndex f = 0; f < kFrames; ++f)
    room.animation.emission.exitance_w_m2[1].push_back(Rgb{4, 4, 4} * static_cast<float>(f % 3));
  const DifferenceLight whole = SolvedRoom(room, {&room.animation.emission}, kFewLines, kFewLines).solve();
  const SolvedRoom rest_of_whole(room, {&room.animation.emission}, kFewLines, kFewLines);
  const auto groups = light_groups(room.scene, room.animation, {{"lamp", {"lamp"}}});
  ASSERT_EQ(groups.size(), 2u);
  PatchSeries sum(room.patches.count(), kFrames);
  for (const LightGroup& group : groups) {
    const SolvedRoom solved(room, {&group.emission}, kFewLines, kFewLines);
    const DifferenceLight light = solved.solve();
    for (PatchId patch = 0; patch < sum.patch_count; ++patch)
      for (FrameIndex f = 0; f < kFrames; ++f)
        sum.at(patch, f) += in_frame(group.scale, f) * solved.irradiance(light, patch, f);
  }
  for (PatchId patch = 0; patch < sum.patch_count; ++patch)
    for (FrameIndex f = 0; f < kFrames; ++f) {
      const Rgb expected = rest_of_whole.irradiance(whole, patch, f);
      ASSERT_NEAR(sum.at(patch, f).r, expected.r, 3e-4) << patch << " " << f;  // of up to 8
      ASSERT_NEAR(sum.at(patch, f).g, expected.g, 3e-4);
      ASSERT_NEAR(sum.at(patch, f).b, expected.b, 3e-4);
    }
}

TEST(SolveDifference, StopsWhenToldTo) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kFewLines, kFewLines);
  std::atomic<int> asked = 0;
  Progress progress;
  progress.stop_requested = [&] { return ++asked > 10; };
  const auto light = solve_difference(solved.window(), Columns::every(kFrames), progress);
  ASSERT_FALSE(light);
  EXPECT_EQ(light.error().fault, api::Fault::stopped);
}

}  // namespace
}  // namespace engine
