// Generated scenes are those they are said to be.
#include "engine/bench/generated_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "engine/bench/bench_runner.h"
#include "engine/bench/bench_scene.h"
#include "engine/bench/limit_plan.h"
#include "engine/bench/load_speed.h"
#include "engine/bench/scaling_plan.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

const std::filesystem::path kExamples = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples";

api::Result<BenchScene> garage_of(const GarageSize& size, const std::filesystem::path& folder) {
  const auto written = write_garage(size, folder / "scenes/made");
  if (!written) return written.error();
  BenchJob job = limit_job("job", {4, 100'000, 100'000}, {});
  job.example = "made";
  if (const auto s = write_bench_job(job, folder / "scenes", folder / "job"); !s) return s.error();
  return load_bench_scene(folder / "job/input");
}

double area_of(const BenchScene& scene) {
  return std::accumulate(scene.patches.area_m2.begin(), scene.patches.area_m2.end(), 0.0);
}

/// [object name] of a patch's centre, summed: where things are, whatever their order.
Vec3 centre_of_plane(const BenchScene& scene, FrameIndex frame) {
  Vec3 sum;
  for (const Facet& facet : scene.patches.facets) {
    const ObjectMotion& motion = scene.animation.objects[facet.object];
    if (motion.is_static(scene.animation.frame_count)) continue;
    for (const PoseSpan& span : motion.spans)
      if (span.first <= frame && frame <= span.last) sum = sum + transform_point(span.pose, facet.corners[0]);
  }
  return sum;
}

TEST(GeneratedGarage, IsTheExampleWhereNothingIsChanged) {
  const tests::TemporaryFolder folder;
  const auto made = garage_of({}, folder.path());
  ASSERT_TRUE(made) << made.error().message;
  const BenchJob job = limit_job("job", {4, 100'000, 100'000}, {});
  ASSERT_TRUE(write_bench_job(job, kExamples, folder.path() / "example"));
  const auto example = load_bench_scene(folder.path() / "example/input");
  ASSERT_TRUE(example);
  EXPECT_EQ(made->patches.count(), 43630u);
  EXPECT_EQ(made->patches.count(), example->patches.count());
  EXPECT_NEAR(area_of(*made), area_of(*example), 1e-3);
  const SceneNumbers ours = scene_numbers(*made), theirs = scene_numbers(*example);
  EXPECT_EQ(ours.moving_polygons, theirs.moving_polygons);
  EXPECT_EQ(ours.static_polygons, theirs.static_polygons);
  EXPECT_NEAR(ours.motion_m2, theirs.motion_m2, 1e-3 * theirs.motion_m2) << "the same flight";
}

TEST(GeneratedGarage, FliesTheSameWayInAnyNumberOfFrames) {
  const tests::TemporaryFolder one, other;
  const auto few = garage_of({.frames = 3}, one.path()), many = garage_of({.frames = 401}, other.path());
  ASSERT_TRUE(few && many);
  EXPECT_EQ(many->animation.frame_count, 401u);
  for (const FrameIndex frame : {0u, 1u, 2u}) {
    const Vec3 a = centre_of_plane(*few, frame), b = centre_of_plane(*many, 200 * frame);
    EXPECT_NEAR(length(a - b), 0, 1e-3);
  }
}

TEST(GeneratedGarage, HasAboutTheMovingPolygonsAndExactlyTheLampsAskedFor) {
  for (const auto& [lamps, moving] : {std::pair{1u, 80u}, {200u, 500u}, {1000u, 5'000u}}) {
    const tests::TemporaryFolder folder;
    const auto made = garage_of({.lamps = lamps, .moving_polygons = moving}, folder.path());
    ASSERT_TRUE(made) << made.error().message;
    const SceneNumbers numbers = scene_numbers(*made);
    EXPECT_EQ(numbers.static_polygons, 6 + lamps);
    EXPECT_NEAR(static_cast<double>(numbers.moving_polygons), moving, 0.15 * moving);
    double lamp_m2 = 0;
    for (const Facet& facet : made->patches.facets)
      if (made->scene.materials[facet.material].name == "lamp") lamp_m2 += facet.area_m2;
    EXPECT_NEAR(lamp_m2, 15 * 1.2 * 0.6, 1e-3) << "the same light, whatever the number of lamps";
  }
}

TEST(Hills, AreReadWithASpeedAndAPeakOfMemoryThatHoldTheirArrays) {
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(write_hills(50'000, folder.path()));
  const auto speed = measure_load_speed(folder.path(), 2);
  ASSERT_TRUE(speed) << speed.error().message;
  EXPECT_GE(speed->polygons, 50'000u);
  EXPECT_EQ(speed->patches, speed->polygons);
  EXPECT_EQ(speed->load_s.size(), 2u);
  EXPECT_GT(speed->load_s[0], 0);
  EXPECT_GT(speed->array_bytes, speed->polygons * sizeof(Facet));
}

TEST(ScalingPlan, EveryJobIsSoundAndOfTheSizeItIsFor) {
  BenchOptions options{.kind = BenchKind::scaling, .quick = true};
  for (const ScalingCurve& curve : scaling_plan(options))
    for (const ScalingPoint& point : curve.points) {
      const tests::TemporaryFolder folder;
      ASSERT_TRUE(write_garage(point.garage, folder.path() / "scenes" / point.job.example));
      ASSERT_TRUE(write_bench_job(point.job, folder.path() / "scenes", folder.path() / "job"));
      const auto scene = load_bench_scene(folder.path() / "job/input");
      ASSERT_TRUE(scene) << point.job.name << ": " << scene.error().message;
      EXPECT_EQ(scene->animation.frame_count, point.garage.frames);
      if (curve.name == "patches") {
        EXPECT_NEAR(scene->patches.count(), point.size, 0.1 * point.size);
      }
    }
}

TEST(LimitPlan, TheGarageIsThatOfTheBarsAndTheQuickOneIsSmaller) {
  for (const bool quick : {false, true}) {
    BenchOptions options;
    options.quick = quick;
    for (const LadderRung& rung : sequence_ladder(quick)) EXPECT_LE(rung.moving_line_count, rung.line_count);
    const BenchJob job =
        limit_job("all_" + name_of({4, 2'000'000, 500'000}), {4, 2'000'000, 500'000}, options);
    EXPECT_EQ(job.name, "all_4_2M_0.5M") << "no folder in a folder";
    EXPECT_FALSE(job.lighting.standard_errors);
    const tests::TemporaryFolder folder;
    ASSERT_TRUE(write_bench_job(job, kExamples, folder.path()));
    const auto scene = load_bench_scene(folder.path() / "input");
    ASSERT_TRUE(scene);
    if (quick)
      EXPECT_LT(scene->patches.count(), 5'000u);
    else
      EXPECT_EQ(scene->patches.count(), 43630u);
  }
}

}  // namespace
}  // namespace engine
