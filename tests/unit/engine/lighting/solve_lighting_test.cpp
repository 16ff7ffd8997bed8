#include "engine/lighting/solve_lighting.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "engine/lighting/compose.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::MovingRoom;

TracedLines trace(const MovingRoom& room, std::uint64_t lines) {
  const auto frames = room.all_frames();
  return *trace_lines(room.patches, room.animation, room.static_rays, frames, {lines, 1}, Progress{});
}

PatchSeries uniform(const MovingRoom& room, Rgb value) {
  PatchSeries series(room.patches.count(), room.animation.frame_count);
  for (Rgb& at : series.values) at = value;
  return series;
}

bool is_there(const MovingRoom& room, PatchId patch, FrameIndex frame) {
  return room.patches.facets[room.patches.facet_of[patch]].object != 2 || frame == 2 || frame == 3 ||
         frame == 7;
}

// Closed, everything emits E and reflects rho: B = E / (1 - rho), with zero variance, whatever moves inside.
// The iteration ends when what is left is below 1e-5 of the mean of B.
TEST(SolveLighting, TheFurnaceGlowsAtExitanceOverOneMinusReflectance) {
  const MovingRoom room(8);
  const TracedLines lines = trace(room, 20'000);
  const Rgb exitance{1, 2, 4}, rho{0.5f, 0.2f, 0};
  const auto solved = solve_lighting(room.patches, lines, std::vector<Rgb>(room.patches.count(), rho),
                                     uniform(room, exitance), Progress{});
  ASSERT_TRUE(solved);
  EXPECT_TRUE(solved->converged);
  EXPECT_GT(solved->iterations, 10u);
  const Rgb expected{1 / 0.5f, 2 / 0.8f, 4};
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (FrameIndex frame = 0; frame < 8; ++frame) {
      if (!is_there(room, patch, frame)) continue;
      const Rgb radiosity = exitance + rho * solved->irradiance_w_m2.at(patch, frame);
      ASSERT_NEAR(radiosity.r, expected.r, 1e-5 * 4)
          << patch << " " << frame;  // of the mean of the largest channel
      ASSERT_NEAR(radiosity.g, expected.g, 1e-5 * 4);
      ASSERT_EQ(radiosity.b, expected.b);
    }
}

TEST(SolveLighting, StrongReflectionTakesMoreIterationsAndConverges) {
  const MovingRoom room(2);
  const TracedLines lines = trace(room, 5'000);
  const auto solved =
      solve_lighting(room.patches, lines, std::vector<Rgb>(room.patches.count(), Rgb{0.9f, 0.9f, 0.9f}),
                     uniform(room, {1, 1, 1}), Progress{});
  ASSERT_TRUE(solved);
  EXPECT_GT(solved->iterations, 60u);
  EXPECT_TRUE(solved->converged);
  EXPECT_NEAR(1 + 0.9f * solved->irradiance_w_m2.at(0, 0).r, 10, 10 * 2e-5);
}

// rho = .999: 10,000 iterations would be needed. The answer is too dark, and it says so.
TEST(SolveLighting, LightThatHardlyDiesIsNotCalledConverged) {
  const MovingRoom room(2);
  const TracedLines lines = trace(room, 1'000);
  const auto solved =
      solve_lighting(room.patches, lines, std::vector<Rgb>(room.patches.count(), Rgb{0.9995f, 0.5f, 0}),
                     uniform(room, {1, 1, 1}), Progress{});
  ASSERT_TRUE(solved);
  EXPECT_FALSE(solved->converged);
  EXPECT_EQ(solved->iterations, engine::kIterationsMax);
  EXPECT_GT(solved->error_left, engine::kIterationError);
  EXPECT_LT(1 + solved->irradiance_w_m2.at(0, 0).r, 0.9 * 2000);
}

TEST(SolveLighting, WithoutLightNothingArrives) {
  const MovingRoom room(2);
  const auto solved = solve_lighting(room.patches, trace(room, 1'000),
                                     std::vector<Rgb>(room.patches.count(), Rgb{0.5f, 0.5f, 0.5f}),
                                     uniform(room, {}), Progress{});
  ASSERT_TRUE(solved);
  EXPECT_EQ(solved->iterations, 0u);
  for (const Rgb& value : solved->irradiance_w_m2.values) ASSERT_EQ(value, Rgb{});
}

TEST(SolveLighting, BlackSurfacesReceiveTheSourceOnce) {
  const MovingRoom room(2);
  const TracedLines lines = trace(room, 5'000);
  const auto solved = solve_lighting(room.patches, lines, std::vector<Rgb>(room.patches.count()),
                                     uniform(room, {1, 1, 1}), Progress{});
  ASSERT_TRUE(solved);
  EXPECT_EQ(solved->iterations, 1u);
  EXPECT_NEAR(solved->irradiance_w_m2.at(0, 0).r, 1, 0x1p-22);
}

TEST(SolveLighting, CountsTheRowsThatNoLineMet) {
  const MovingRoom room(2, 0.2);
  const TracedLines lines = trace(room, 300);
  const auto solved = solve_lighting(room.patches, lines, std::vector<Rgb>(room.patches.count()),
                                     uniform(room, {1, 1, 1}), Progress{});
  ASSERT_TRUE(solved);
  EXPECT_EQ(solved->empty_rows, SampledOperator(room.patches, lines).empty_rows().size());
  EXPECT_GT(solved->empty_rows, 100u);
}

TEST(SolveLighting, StopsWhenToldTo) {
  const MovingRoom room(2);
  std::atomic<int> asked = 0;
  Progress progress;
  progress.stop_requested = [&] { return ++asked > 200; };
  const auto solved = solve_lighting(room.patches, trace(room, 5'000),
                                     std::vector<Rgb>(room.patches.count(), Rgb{0.99f, 0.99f, 0.99f}),
                                     uniform(room, {1, 1, 1}), progress);
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().fault, api::Fault::stopped);
}

/// Everything emits 2 and reflects a half, and all of it travels by lines.
MovingRoom& glow(MovingRoom& room) {
  room.animation.emission.exitance_w_m2[0] = {{2, 2, 2}};
  return room;
}

TEST(IndirectLight, OfAFurnaceOfPureLinesIsExitanceOverOneMinusReflectanceInEveryWindow) {
  MovingRoom room(2 * kSolveWindow + 5, 1.0);
  const auto frames = glow(room).all_frames();
  const auto indirect = indirect_light(room.lit(), frames, nullptr, {2'000, 1}, Progress{});
  ASSERT_TRUE(indirect);
  const PatchSeries radiosity = compose_radiosity(room.lit(), frames, nullptr, indirect->irradiance_w_m2);
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (FrameIndex frame = 0; frame < frames.size(); ++frame) {
      const float expected = is_there(room, patch, frame) ? 4.0f : 0.0f;
      ASSERT_NEAR(radiosity.at(patch, frame).r, expected, 1e-5 * expected) << patch << " " << frame;
    }
  EXPECT_EQ(indirect->counts.tracing.lines, 2'000u);  // the same in each of the three windows
}

// The same lines for every frame; what is left of the iteration is below 1e-5 of the mean
// in both.
TEST(IndirectLight, AFrameSolvedAloneIsTheFrameOfTheWindow) {
  MovingRoom room(6);
  room.animation.emission.exitance_w_m2.push_back({{9, 9, 9}});
  room.scene.materials.push_back({"lamp", {0.5f, 0.5f, 0.5f}, {}, false});
  room.patches.facets[5].material = 1;  // one wall glows
  const auto frames = room.all_frames();
  const auto together = indirect_light(room.lit(), frames, nullptr, {20'000, 3}, Progress{});
  ASSERT_TRUE(together);
  for (const FrameIndex frame : {0u, 2u, 5u}) {
    const auto alone =
        indirect_light(room.lit(), std::vector<FrameIndex>{frame}, nullptr, {20'000, 3}, Progress{});
    ASSERT_TRUE(alone);
    double difference = 0, mean = 0;
    for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
      const float a = alone->irradiance_w_m2.at(patch, 0).r, b = together->irradiance_w_m2.at(patch, frame).r;
      difference = std::max(difference, std::abs(double{a} - b));
      mean += b / static_cast<float>(room.patches.count());
    }
    EXPECT_GT(mean, 0.5);
    EXPECT_LT(difference, 2 * 1e-5 * 9);  // of either, and the mean source is below 9
  }
}

TEST(Compose, RadiosityIsExitanceAndWhatIsReflectedOfBothKindsOfLight) {
  MovingRoom room(4, 1.0, true);
  room.animation.emission.exitance_w_m2[0] = {{1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {8, 0, 0}};
  const std::vector<FrameIndex> frames{1, 3};
  PatchSeries direct(room.patches.count(), 2), indirect = direct;
  for (Rgb& value : direct.values) value = {0.5f, 2, 0};
  for (Rgb& value : indirect.values) value = {1, 0, 6};
  const PatchSeries both = compose_radiosity(room.lit(), frames, &direct, indirect);
  const PatchSeries only = compose_radiosity(room.lit(), frames, nullptr, indirect);
  PatchSeries reflected = indirect;
  reflect(room.lit(), frames, reflected);
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (std::uint32_t k = 0; k < 2; ++k) {
      if (!is_there(room, patch, frames[k])) {
        ASSERT_EQ(both.at(patch, k), Rgb{});
        ASSERT_EQ(reflected.at(patch, k), Rgb{});
        continue;
      }
      const float emitted = room.patches.is_back(patch) ? 0.0f : k == 0 ? 2.0f : 8.0f;  // fronts only
      ASSERT_EQ(both.at(patch, k), (Rgb{emitted + 0.75f, 1, 3}));
      ASSERT_EQ(only.at(patch, k), (Rgb{emitted + 0.5f, 0, 3}));
      ASSERT_EQ(reflected.at(patch, k), (Rgb{0.5f, 0, 3}));
    }
}

}  // namespace
}  // namespace engine
