#include "engine/pipeline/window_solver.h"

#include <gtest/gtest.h>

#include "engine/pipeline/frame_by_frame.h"
#include "engine/pipeline/light_directly.h"
#include "tests/unit/engine/pipeline/solve_room.h"

namespace engine {
namespace {

using tests::LitRoom;

constexpr FrameIndex kFrames = 10;

/// One group with direct light apart, and a window of all frames.
struct OneWindow {
  LitRoom room{kFrames};
  LitScene lit = room.lit();
  std::vector<FrameIndex> frames = room.all_frames();
  std::vector<LitGroup> groups{{{"", room.animation.emission, {Rgb{1, 1, 1}}}, {}}};
  std::vector<GroupSource> sources;
  std::vector<RestLight> rests;
  RestTransport transport{lit, tests::trace(room, {}, {5'000, 1})};

  OneWindow() {
    groups[0].direct = *direct_light(room.patches, room.animation, room.animation.emission, room.static_rays,
                                     frames, {16, 1, 1}, {});
    sources.push_back({&groups[0].group.emission, &groups[0].direct});
    SolveCounts counts;
    rests = *light_at_rest(lit, sources, {10'000, 1}, counts, {});
  }
  WindowSolver window(const LineOptions& lines = {5'000, 1}) const {
    return {lit, groups, sources, rests, transport, frames, tests::trace(room, frames, lines)};
  }
};

TEST(WindowSolver, SolvesInStepsWhatItSolvesAtOnce) {
  const OneWindow room;
  SolveCounts counts;
  WindowSolver at_once = room.window(), in_steps = room.window();
  const std::vector<FrameIndex> some{0, 4, 9}, all{0, 2, 3, 4, 9}, fresh{2, 3};
  ASSERT_TRUE(at_once.solve(all, Carried::wanted, counts, {}));
  ASSERT_TRUE(in_steps.solve(some, Carried::wanted, counts, {}));
  EXPECT_EQ(in_steps.solved(), some);
  ASSERT_TRUE(in_steps.solve(fresh, Carried::wanted, counts, {}));
  ASSERT_TRUE(in_steps.solve(all, Carried::wanted, counts, {}));  // nothing is left to do
  EXPECT_EQ(in_steps.solved(), all);
  EXPECT_TRUE(counts.converged);
  const PatchSeries a = at_once.at_solved(0), b = in_steps.at_solved(0);
  ASSERT_EQ(a.frame_count, 5u);
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    ASSERT_NEAR(a.values[k].g, b.values[k].g, 1e-4);
    ASSERT_NEAR(at_once.carried()[0]->values[k].g, in_steps.carried()[0]->values[k].g, 1e-4);
  }
}

TEST(WindowSolver, InEveryFrameTheSolvedOnesAreAsTheyWereSolved) {
  const OneWindow room;
  SolveCounts counts;
  WindowSolver window = room.window();
  const std::vector<FrameIndex> some{0, 4, 9};
  ASSERT_TRUE(window.solve(some, Carried::wanted, counts, {}));
  const PatchSeries solved = window.at_solved(0);
  const auto all = window.in_every_frame(0, api::Interpolation::linear, {});
  ASSERT_TRUE(all);
  ASSERT_EQ(all->frame_count, kFrames);
  for (PatchId patch = 0; patch < solved.patch_count; ++patch)
    for (std::uint32_t k = 0; k < some.size(); ++k)
      ASSERT_NEAR(all->at(patch, some[k]).g, solved.at(patch, k).g, 4 * kIterationError);
}

TEST(WindowSolver, RadiosityIsWhatIsEmittedAndReflectedOfAllLight) {
  const OneWindow room;
  SolveCounts counts;
  WindowSolver window = room.window();
  const std::vector<FrameIndex> some{1, 3, 7};
  ASSERT_TRUE(window.solve(some, Carried::wanted, counts, {}));
  const PatchSeries indirect = window.at_solved(0), radiosity = window.radiosity_at_solved();
  int there = 0;
  for (PatchId patch = 0; patch < radiosity.patch_count; ++patch)
    for (std::uint32_t k = 0; k < some.size(); ++k) {
      const bool gone =
          room.room.patches.facets[room.room.patches.facet_of[patch]].object == 2 && some[k] == 1;
      const Rgb arriving = indirect.at(patch, k) + room.groups[0].direct.irradiance_w_m2.at(patch, some[k]);
      const Rgb expected = room.lit.exitance(room.room.animation.emission, patch, some[k]) +
                           room.lit.reflectance(patch, some[k]) * arriving;
      ASSERT_NEAR(radiosity.at(patch, k).g, gone ? 0 : expected.g, 1e-5);
      there += gone ? 0 : 1;
    }
  EXPECT_GT(there, 100);
}

TEST(WindowSolver, CountsPatchesThatAreThereAndThatNoLineMeets) {
  const OneWindow room;
  const WindowSolver few = room.window({30, 1, 0, 0});
  std::uint64_t empty = 0;
  for (PatchId patch = 0; patch < room.room.patches.count(); ++patch)
    for (FrameIndex f = 0; f < kFrames; ++f) {
      const std::uint32_t object = room.room.patches.facets[room.room.patches.facet_of[patch]].object;
      const bool there = object == 1 || (object == 2 && (f == 2 || f == 3 || f == 7));
      empty += there && few.lines().crossings.at(patch, f) == 0 ? 1 : 0;
    }
  EXPECT_GT(empty, 10u);
  EXPECT_EQ(few.empty_rows().count, empty);
  EXPECT_EQ(room.window().empty_rows().count, 0u);
}

/// Direct light of the whole room as one group.
std::vector<LitGroup> light(const LitRoom& room, const api::LightingOptions& options) {
  const RunHooks hooks;
  api::JobReport report;
  StageClock clock(hooks, report);
  Checkpoints none;
  std::vector<LightGroup> groups{{"", room.animation.emission, {Rgb{1, 1, 1}}}};
  auto lit = light_directly(room.lit(), std::move(groups), room.all_frames(), options, none, clock);
  EXPECT_TRUE(lit);
  return std::move(*lit);
}

double noise(const LitRoom& room, const std::vector<LitGroup>& groups) {
  const auto all = pointers_to(groups);
  const auto frames = room.all_frames();
  PatchSeries error(room.patches.count(), kFrames), reflected = error;
  add_direct_irradiance(all, frames, reflected);
  to_standard_error(room.lit(), all, frames, error);
  to_radiosity(room.lit(), all, frames, reflected);
  return root_mean_square_error(room.lit(), error) / mean_radiosity(room.lit(), reflected);
}

// Passes are added by what the first one's noise says, so the target may be missed by its scatter.
TEST(LightDirectly, PassesBringTheNoiseToItsPartOfTheTarget) {
  const LitRoom room(kFrames);
  api::LightingOptions options = tests::quick_options();
  const auto once = light(room, options);
  options.target_error = std::sqrt(2.0) * noise(room, once) / 3;
  const auto better = light(room, options);
  EXPECT_LT(noise(room, better), 1.2 * noise(room, once) / 3);
  EXPECT_GT(noise(room, better), 0.5 * noise(room, once) / 3);
  EXPECT_GE(better[0].direct.counts.light_samples, 8 * once[0].direct.counts.light_samples);
  options.target_error = 1;
  EXPECT_EQ(light(room, options)[0].direct.irradiance_w_m2.values, once[0].direct.irradiance_w_m2.values);
}

TEST(LightDirectly, WhereLinesCarryEverythingThereIsNone) {
  const LitRoom room(kFrames);
  api::LightingOptions options = tests::quick_options();
  options.direct = api::DirectLight::pure;
  const auto groups = light(room, options);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_TRUE(groups[0].direct.irradiance_w_m2.values.empty());
}

TEST(LightDirectly, WithoutStandardErrorsThereIsNoVariance) {
  const LitRoom room(kFrames);
  api::LightingOptions options = tests::quick_options();
  EXPECT_FALSE(light(room, options)[0].direct.variance.values.empty());
  options.standard_errors = false;
  EXPECT_TRUE(light(room, options)[0].direct.variance.values.empty());
}

TEST(Frozen, IsOneFrameAsItIsInTheAnimation) {
  LitRoom room(kFrames);
  room.animation.emission.exitance_w_m2[1].clear();
  for (FrameIndex f = 0; f < kFrames; ++f)
    room.animation.emission.exitance_w_m2[1].push_back(Rgb{1, 1, 1} * static_cast<float>(f));
  room.animation.reflectance = {{}, {{0.1f, 0.1f, 0.1f}}, {}};
  for (FrameIndex f = 0; f < kFrames; ++f)
    room.animation.reflectance[2].push_back(Rgb{0.05f, 0, 0} * static_cast<float>(f));
  SourceMotion bulb;
  bulb.direction = {{0, 0, -1}};
  for (FrameIndex f = 0; f < kFrames; ++f) {
    bulb.position.push_back({static_cast<float>(f), 0, 0});
    bulb.intensity.push_back({0, static_cast<float>(f), 0});
  }
  room.animation.emission.sources = {bulb};
  for (const FrameIndex frame : {0u, 3u, 9u}) {
    const Animation alone = frozen(room.animation, frame);
    EXPECT_EQ(alone.frame_count, 1u);
    ASSERT_EQ(alone.objects.size(), 3u);
    EXPECT_TRUE(alone.objects[0].is_static(1));
    ASSERT_TRUE(alone.objects[1].is_static(1));
    EXPECT_EQ(alone.objects[1].spans[0].pose, room.animation.objects[1].spans[frame].pose);
    EXPECT_EQ(alone.objects[2].spans.size(), frame == 3 ? 1u : 0u);
    const auto f = static_cast<float>(frame);
    EXPECT_EQ(alone.emission.exitance(1, 0), (Rgb{f, f, f}));
    EXPECT_EQ(material_reflectance(room.scene, alone, 2, 0), (Rgb{0.05f * f, 0, 0}));
    EXPECT_EQ(material_reflectance(room.scene, alone, 1, 0), (Rgb{0.1f, 0.1f, 0.1f}));
    EXPECT_EQ(material_reflectance(room.scene, alone, 0, 0), room.scene.materials[0].reflectance);
    ASSERT_EQ(alone.emission.sources.size(), 1u);
    EXPECT_EQ(alone.emission.sources[0].position[0].x, f);
    EXPECT_EQ(alone.emission.sources[0].intensity[0].g, f);
    EXPECT_TRUE(alone.emission.sources[0].is_static());
  }
}

}  // namespace
}  // namespace engine
