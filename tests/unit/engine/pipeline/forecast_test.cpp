#include "engine/pipeline/forecast.h"

#include <gtest/gtest.h>

#include "engine/pipeline/run_pipeline.h"
#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

/// A pace that does not depend on the machine, so that sizes alone are compared.
constexpr MachinePace kPace{2e-6, 0.5e-6, 1e-9, 1.85};

JobSize a_size() {
  JobSize size;
  size.polygons = size.facets = 50;
  size.patches = 10'000;
  size.coarse_patches = 500;
  size.frames = 24;
  size.solved_frames = 8;
  size.moving_share = 0.1;
  size.lights = 2;
  size.light_samples = 16;
  size.lines = 1e6;
  size.moving_lines = 5e5;
  size.estimate_lines = 1e5;
  size.crossings_per_line = 3;
  size.bounces = 15;
  size.pixels = 24 * 320 * 180;
  size.image_samples = 4 * size.pixels;
  return size;
}

double seconds_of(const JobSize& size) {
  return forecast_of(size, 2, kPace).seconds;
}

TEST(Forecast, MoreOfAnythingTakesLongerAndNoLessMemory) {
  const JobSize base = a_size();
  for (double JobSize::*count :
       {&JobSize::patches, &JobSize::frames, &JobSize::solved_frames, &JobSize::lights,
        &JobSize::light_samples, &JobSize::lines, &JobSize::estimate_lines, &JobSize::crossings_per_line,
        &JobSize::pixels, &JobSize::image_samples, &JobSize::coarse_patches}) {
    JobSize more = base;
    more.*count *= 4;
    EXPECT_GT(seconds_of(more), seconds_of(base));
    EXPECT_GE(forecast_memory_bytes(more), forecast_memory_bytes(base));
  }
}

// Each is held at every pose of a window of frames, and lines go through each in every frame.
TEST(Forecast, KnowsOfThousandsOfFacetsThatMove) {
  JobSize few = a_size(), many = a_size();
  few.moving_facets = few.moving_patches = 20;
  many.moving_facets = many.moving_patches = 20'000;
  constexpr std::uint64_t kPerPose = 240;  // a box, a test for rays and one for lines
  EXPECT_GT(forecast_memory_bytes(many), kPerPose * 20'000 * 24);
  EXPECT_GT(forecast_memory_bytes(many), forecast_memory_bytes(few));
  EXPECT_GT(seconds_of(many), seconds_of(few));
}

TEST(Forecast, WhatIsAskedForBesideRadiosityTakesMemory) {
  JobSize more = a_size();
  more.replicates = 8;
  const double one_series = 12 * more.patches * more.frames;
  const auto before = static_cast<double>(forecast_memory_bytes(more));
  more.with_errors = true;
  const auto with_errors = static_cast<double>(forecast_memory_bytes(more));
  EXPECT_GE(with_errors, before + one_series - 1) << "the variance of direct light";
  more.solved_groups = 3;
  EXPECT_GT(static_cast<double>(forecast_memory_bytes(more)), with_errors + 4 * one_series);
}

TEST(Forecast, PicturesTakeMemoryByTheirSizeAndFilesByTheirKind) {
  JobSize none = a_size();
  none.lines = none.moving_lines = none.estimate_lines = 1000;  // so that pictures take most
  JobSize small = none, large = none, exr = none;
  small.pictures = {{.pixels = 320 * 180, .width = 320}};
  large.pictures = {{.pixels = 1920 * 1080, .width = 1920}};
  exr.pictures = {{.pixels = 320 * 180, .width = 320, .exr = true}};
  EXPECT_GE(forecast_memory_bytes(small), forecast_memory_bytes(none));
  EXPECT_GT(forecast_memory_bytes(large), forecast_memory_bytes(small) + 4 * 3 * 1920 * 1080);
  EXPECT_GT(forecast_memory_bytes(exr), forecast_memory_bytes(small) + 100'000'000)
      << "libraries that it draws in";
}

TEST(Forecast, TwiceTheCoresHalveWhatIsDoneInParallel) {
  MachinePace four = kPace;
  four.cores = 2 * kPace.cores;
  const StageSeconds some = forecast_seconds(a_size(), kPace), fewer = forecast_seconds(a_size(), four);
  const auto solve = static_cast<std::size_t>(api::Stage::solve);
  EXPECT_DOUBLE_EQ(some[solve], 2 * fewer[solve]);
}

TEST(Forecast, EveryStageButTheFirstIsExpectedToTakeTime) {
  const StageSeconds seconds = forecast_seconds(a_size(), kPace);
  for (std::size_t k = 1; k < seconds.size(); ++k) EXPECT_GT(seconds[k], 0) << k;
}

/// A lamp of a square metre over the same square, one frame or more.
struct AJob {
  SceneFolder folder;
  api::JobRequest request;

  AJob(double patch_edge_m, std::uint64_t lines, std::uint32_t frames) {
    folder.with("scene.obj", kSquare + "o lamp\nf 1 2 3 4\n");
    request.scene.allow_dark = true;
    request.frame_count = frames;
    request.lighting.mode = api::LightingMode::reference;
    request.lighting.patch_edge_m = patch_edge_m;
    request.lighting.line_count = lines;
  }
  api::Forecast forecast() const {
    api::JobReport report;
    EXPECT_TRUE(check_job(request, folder.path(), 2, report));
    EXPECT_TRUE(report.forecast);
    return report.forecast.value_or(api::Forecast{});
  }
};

TEST(Forecast, OfACheckOrdersJobsByTheirWork) {
  const api::Forecast small = AJob(0.1, 100'000, 1).forecast();
  const api::Forecast medium = AJob(0.1, 20'000'000, 1).forecast();
  const api::Forecast large = AJob(0.01, 60'000'000, 100).forecast();
  EXPECT_LT(2 * small.seconds, medium.seconds);
  EXPECT_LT(2 * medium.seconds, large.seconds);
  EXPECT_LT(small.memory_bytes, medium.memory_bytes);
  EXPECT_LT(medium.memory_bytes, large.memory_bytes);
  EXPECT_EQ(small.patches, 200u) << "a hundred cells, both sides";
  EXPECT_EQ(large.frames, 100u);
}

TEST(Forecast, AMachineHasAPaceOfItsOwn) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  scene.corners = {0, 1, 2, 3};
  scene.polygons = {{0, 4, 0, 0, 1}};
  scene.objects.resize(1);
  scene.materials.resize(1);
  Animation animation;
  animation.objects.resize(1);
  animation.objects[0].spans = {{0, 0, {}}};
  animation.emission.exitance_w_m2.resize(1, {{}});
  const MachinePace pace = measure_pace(scene, animation, 2);
  // From a tenth to ten thousand times what a core of 2020 takes: no machine this runs on is outside.
  EXPECT_GT(pace.line_s, 1e-9);
  EXPECT_LT(pace.line_s, 1e-2);
  EXPECT_GT(pace.ray_s, 1e-10);
  EXPECT_LT(pace.ray_s, 1e-2);
  EXPECT_GT(pace.update_s, 1e-11);
  EXPECT_LT(pace.update_s, 1e-4);
  EXPECT_EQ(pace.cores, 1.85);
}

}  // namespace
}  // namespace engine
