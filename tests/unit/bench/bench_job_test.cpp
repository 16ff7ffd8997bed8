// Jobs of the bench are sound jobs, and those of single frames show the same as those frames.
#include "engine/bench/bench_job.h"

#include <gtest/gtest.h>

#include "engine/bench/bench_files.h"
#include "engine/bench/bench_plan.h"
#include "engine/bench/bench_scene.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

const std::filesystem::path kExamples = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples";

api::JobRequest request_in(const std::filesystem::path& folder) {
  const auto bytes = read_bench_file(folder / "input/animation.json");
  EXPECT_TRUE(bytes);
  const auto request = api::parse_job_request(*bytes);
  EXPECT_TRUE(request) << request.error().message;
  return *request;
}

TEST(BenchPlan, EveryJobIsSoundAndAsPlanned) {
  for (const bool quick : {false, true}) {
    const auto groups = bench_plan({.quick = quick});
    ASSERT_EQ(groups.size(), 4u);
    for (const BenchGroup& group : groups) {
      std::vector<BenchJob> jobs = group.runs;
      jobs.push_back(group.full);
      for (const BenchJob& job : jobs) {
        const tests::TemporaryFolder folder;
        const auto written = write_bench_job(job, kExamples, folder.path());
        ASSERT_TRUE(written) << written.error().message;
        const api::JobRequest request = request_in(folder.path());
        EXPECT_EQ(request.frame_count, kBenchFrames);
        EXPECT_EQ(request.lighting.mode, job.lighting.mode) << job.name;
        EXPECT_EQ(request.lighting.line_count, group.full.lighting.line_count);
        EXPECT_EQ(request.lighting.seed, group.full.lighting.seed);
      }
    }
  }
}

TEST(BenchJob, FramesAloneShowWhatTheSequenceShowsThen) {
  const auto groups = bench_plan({});
  const BenchGroup& office = groups[3];
  const tests::TemporaryFolder whole_folder, part_folder;
  ASSERT_TRUE(write_bench_job(office.full, kExamples, whole_folder.path()));
  ASSERT_TRUE(write_bench_job(office.alone, kExamples, part_folder.path()));
  const auto whole = load_bench_scene(whole_folder.path() / "input");
  const auto part = load_bench_scene(part_folder.path() / "input");
  ASSERT_TRUE(whole && part);
  const auto& frames = office.alone.frames;
  ASSERT_EQ(part->animation.frame_count, frames.size());
  EXPECT_EQ(part->patches.count(), whole->patches.count());
  const auto pose = [](const BenchScene& scene, std::size_t object, FrameIndex frame) {
    for (const PoseSpan& span : scene.animation.objects[object].spans)
      if (frame <= span.last) return span.pose;
    return Pose{};
  };
  for (std::size_t object = 0; object < whole->scene.objects.size(); ++object)
    for (FrameIndex k = 0; k < frames.size(); ++k)
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
          EXPECT_NEAR(pose(*part, object, k).m[row][column], pose(*whole, object, frames[k]).m[row][column],
                      1e-12)
              << whole->scene.objects[object].name;
}

TEST(BenchJob, WithoutItsExampleIsAnError) {
  const tests::TemporaryFolder folder;
  const auto written = write_bench_job(bench_plan({})[0].full, folder.path() / "nowhere", folder.path());
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, api::Fault::not_found);
}

// The office is as large as the third scene of Besuievsky & Pueyo: 4,200 polygons of which 500 move, about
// 50,000 patches. The garage's patches are those of the bars that its times are held against.
TEST(BenchPlan, ScenesHaveTheSizesOfThePaper) {
  const auto groups = bench_plan({});
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(write_bench_job(groups[3].full, kExamples, folder.path()));
  const auto office = load_bench_scene(folder.path() / "input");
  ASSERT_TRUE(office);
  const SceneNumbers numbers = scene_numbers(*office);
  EXPECT_NEAR(static_cast<double>(numbers.static_polygons + numbers.moving_polygons), 4200, 100);
  EXPECT_NEAR(static_cast<double>(numbers.moving_polygons), 500, 20);
  EXPECT_NEAR(office->patches.count(), 50000, 1000);
  EXPECT_NEAR(numbers.box_m2, 2 * (12 * 9 + 12 * 3 + 9 * 3), 1);

  const tests::TemporaryFolder garage_folder;
  ASSERT_TRUE(write_bench_job(groups[0].full, kExamples, garage_folder.path()));
  const auto garage = load_bench_scene(garage_folder.path() / "input");
  ASSERT_TRUE(garage);
  EXPECT_EQ(garage->patches.count(), 43630u);
}

}  // namespace
}  // namespace engine
