#include "engine/lighting/solve_at_rest.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using tests::MovingRoom;

constexpr std::uint64_t kLines = 5'000;

RestLight solve(const MovingRoom& room, Rgb source, Rgb reflectance) {
  const std::uint32_t patches = room.patches.count();
  const TracedLines lines = tests::trace(room, {}, {kLines, 1});
  const std::vector<Rgb> rho(patches, reflectance);
  auto light = solve_at_rest(room.patches, lines, {room.patches, lines, rho},
                             std::vector<Rgb>(patches, source), rho, Progress{});
  EXPECT_TRUE(light);
  return std::move(*light);
}

bool moves(const MovingRoom& room, PatchId patch) {
  return !room.lit().at_rest(patch);
}

// Closed, everything emits E and reflects rho: B = E / (1 - rho), with zero variance.
TEST(SolveAtRest, TheFurnaceGlowsAtExitanceOverOneMinusReflectance) {
  const MovingRoom room(8);
  const RestLight light = solve(room, {1, 2, 4}, {0.5f, 0.2f, 0});
  EXPECT_TRUE(light.convergence.converged);
  EXPECT_LE(light.convergence.error_left, kIterationError);
  for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
    if (moves(room, patch)) continue;
    const Rgb b = light.radiosity_w_m2[patch];
    ASSERT_NEAR(b.r, 2, 1e-5 * 4) << patch;  // of the mean of the largest channel
    ASSERT_NEAR(b.g, 2.5, 1e-5 * 4);
    ASSERT_EQ(b.b, 4);
    ASSERT_NEAR(1 + 0.5f * light.irradiance_w_m2[patch].r, 2, 1e-5 * 4);
  }
}

TEST(SolveAtRest, IsTheSolutionOfItsEquations) {
  const tests::LitRoom room(4);
  const std::uint32_t patches = room.patches.count();
  const TracedLines lines = tests::trace(room, {}, {kLines, 3});
  std::vector<Rgb> source(patches), rho(patches);
  std::vector<double> b(patches);
  tests::OneFrame frame{tests::exchanges_in(lines, patches, 0), lines.crossings.static_count};
  tests::Dense system = tests::operator_of(frame);
  double mean = 0, area = 0;
  for (PatchId i = 0; i < patches; ++i) {
    source[i] = {0, static_cast<float>(i % 7), 0};
    rho[i] = {0.9f, static_cast<float>(i % 5) / 6, 0.3f};
    b[i] = source[i].g;
    for (PatchId j = 0; j < patches; ++j)
      system.at(i, j) = (i == j ? 1 : 0) - double{rho[i].g} * system.at(i, j);
  }
  const std::vector<double> expected = solve_dense(system, b);
  for (PatchId i = 0; i < patches; ++i) {
    mean += room.patches.area_m2[i] * expected[i];
    area += room.patches.area_m2[i];
  }
  const auto light = solve_at_rest(room.patches, lines, {room.patches, lines, rho}, source, rho, Progress{});
  ASSERT_TRUE(light);
  for (PatchId i = 0; i < patches; ++i) {
    ASSERT_NEAR(light->radiosity_w_m2[i].g, expected[i], 2 * kIterationError * mean / area) << i;
    ASSERT_EQ(light->radiosity_w_m2[i].r, 0);
  }
}

// Iterating alone it would take 130 and 27,000 of them.
TEST(SolveAtRest, StrongReflectionTakesFewIterationsTo) {
  const MovingRoom room(2);
  const RestLight light = solve(room, {1, 1, 1}, {0.9f, 0.9f, 0.9f});
  EXPECT_LE(light.convergence.iterations, 20u);
  EXPECT_TRUE(light.convergence.converged);
  // kIterationError, and the rounding of sums, 3 x 6e-8, that bounces add up to ten times of.
  EXPECT_NEAR(light.radiosity_w_m2[0].r, 10, 10 * (1e-5 + 2e-6));
}

TEST(SolveAtRest, LightThatHardlyDiesIsFoundAsWell) {
  const MovingRoom room(2, 1.0);
  const RestLight light = solve(room, {1, 1, 1}, {0.9995f, 0.5f, 0});
  EXPECT_TRUE(light.convergence.converged);
  EXPECT_LE(light.convergence.iterations, 100u);
  EXPECT_NEAR(light.radiosity_w_m2[0].r, 2000, 2000 * 1e-3);  // rounding of rho alone is 6e-8 / 5e-4
}

TEST(SolveAtRest, WithoutLightNothingArrivesAndItIsSoonKnown) {
  const MovingRoom room(2);
  const RestLight light = solve(room, {}, {0.5f, 0.5f, 0.5f});
  EXPECT_TRUE(light.convergence.converged);
  EXPECT_LE(light.convergence.iterations, 1u);
  for (const Rgb& value : light.irradiance_w_m2) ASSERT_EQ(value, Rgb{});
}

TEST(SolveAtRest, BlackSurfacesReceiveTheSourceOnce) {
  const MovingRoom room(2);
  const RestLight light = solve(room, {1, 1, 1}, {});
  EXPECT_LE(light.convergence.iterations, 2u);
  EXPECT_NEAR(light.irradiance_w_m2[0].r, 1, 0x1p-21);
  EXPECT_EQ(light.radiosity_w_m2[0], (Rgb{1, 1, 1}));
}

TEST(SolveAtRest, StopsWhenToldTo) {
  const MovingRoom room(2);
  const TracedLines lines = tests::trace(room, {}, {kLines, 1});
  std::atomic<int> asked = 0;
  Progress progress;
  progress.stop_requested = [&] { return ++asked > 100; };
  const std::uint32_t patches = room.patches.count();
  const std::vector<Rgb> rho(patches, Rgb{0.99f, 0.99f, 0.99f});
  const auto light = solve_at_rest(room.patches, lines, {room.patches, lines, rho},
                                   std::vector<Rgb>(patches, Rgb{1, 1, 1}), rho, progress);
  ASSERT_FALSE(light);
  EXPECT_EQ(light.error().fault, api::Fault::stopped);
}

TEST(LightAtRest, CountsItsLinesAndThePatchesThatNoneOfThemMet) {
  const tests::LitRoom room(3, 0.5);
  const GroupSource source[] = {{&room.animation.emission}};
  SolveCounts counts;
  ASSERT_TRUE(light_at_rest(room.lit(), source, {60, 1, 0, 8}, counts, Progress{}));
  EXPECT_EQ(counts.tracing.lines, 60u);
  EXPECT_EQ(counts.tracing.moving_hits, 0u);
  EXPECT_EQ(counts.tracing.local_lines, 0u);
  const TracedLines lines = tests::trace(room, {}, {60, 1, 0, 8});
  std::uint64_t empty = 0;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    empty += room.lit().at_rest(patch) && lines.crossings.static_count[patch] == 0 ? 1 : 0;
  EXPECT_GT(empty, 10u);
  EXPECT_EQ(counts.empty_rows.count, empty * room.animation.frame_count);
  EXPECT_EQ(counts.exchanges, lines.static_rows.entry_count());
  SolveCounts with_local;
  ASSERT_TRUE(light_at_rest(room.lit(), source, {60, 1}, with_local, Progress{}));
  EXPECT_EQ(with_local.empty_rows.count, 0u);
  EXPECT_GE(with_local.tracing.local_lines, empty);
}

}  // namespace
}  // namespace engine
