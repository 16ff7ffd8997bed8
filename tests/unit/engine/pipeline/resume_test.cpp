// A run that is cut off, and the one after it.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "engine/base/checkpoint.h"
#include "engine/pipeline/job_fingerprint.h"
#include "engine/pipeline/run_pipeline.h"
#include "engine/pipeline/solved_checkpoint.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

/// A lamp over a floor, eight frames seen by one camera.
struct AJob {
  SceneFolder input;
  tests::TemporaryFolder temporary;
  fs::path artefacts = temporary.path() / "artefacts", checkpoint = temporary.path() / "checkpoint";
  api::JobRequest request;

  AJob() {
    input.with("scene.obj", "mtllib scene.mtl\n" + kSquare +
                                "v 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nusemtl white\nf 1 2 3 4\n"
                                "usemtl glow\nf 8 7 6 5\n");
    input.with("scene.mtl", "newmtl white\nKd 0.5 0.5 0.5\nnewmtl glow\nKd 0.5 0.5 0.5\nKe 3 3 3\n");
    fs::create_directories(artefacts);
    request.frame_count = 8;
    request.scene.cameras["front"] = a_camera();
    request.images = {a_small_image()};
    request.lighting.patch_edge_m = 0.25;
    request.lighting.estimate_patch_edge_m = 0.5;
    request.lighting.line_count = request.lighting.moving_line_count = 20'000;
    request.lighting.estimate_line_count = 4'000;
  }
  static api::Camera a_camera() {
    api::Camera camera;
    camera.position.keys = {{0, {0.5, 0.5, 1.9}}};
    camera.target.keys = {{0, {0.5, 0.5, 0}}};
    camera.vertical_fov_degrees.keys = {{0, 60}};
    return camera;
  }
  static api::ImageOptions a_small_image() {
    api::ImageOptions image;
    image.camera = "front";
    image.width = 32;
    image.height = 18;
    return image;
  }

  /// Told to stop when that much of the images is done; beyond 1: never.
  api::Status run(api::JobReport& report, double stop_at_fraction = 2) {
    bool stop = false;
    RunHooks hooks;
    hooks.checkpoint_folder = checkpoint;
    hooks.progress = [&](const api::ProgressLine& line) {
      if (line.stage == api::Stage::images && line.stage_fraction >= stop_at_fraction) stop = true;
    };
    hooks.stop_requested = [&] { return stop; };
    return run_pipeline(request, input.path(), artefacts, hooks, report);
  }

  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(artefacts))
      if (entry.is_regular_file()) all[fs::relative(entry, artefacts)] = tests::bytes_of(entry);
    return all;
  }
};

double count_of(const api::JobReport& report, std::string_view name) {
  for (const auto& [key, value] : report.counts)
    if (key == name) return value;
  return 0;
}

TEST(Resume, ImagesThatAreFinishedAreNotRenderedAgainAndTheBytesAreThoseOfOneRun) {
  AJob whole, cut;
  api::JobReport report;
  ASSERT_TRUE(whole.run(report)) << report.message;
  EXPECT_EQ(count_of(report, "resumed_images"), 0);
  EXPECT_FALSE(fs::exists(whole.checkpoint)) << "nothing stays of a run that succeeded";

  api::JobReport first, second;
  const auto stopped = cut.run(first, 0.3);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().fault, api::Fault::stopped);
  const fs::path image = cut.artefacts / "images/front/0000.png";
  ASSERT_TRUE(fs::exists(image));
  const auto written = fs::last_write_time(image);
  ASSERT_TRUE(cut.run(second));
  EXPECT_GE(count_of(second, "resumed_images"), 2);
  EXPECT_LT(count_of(second, "resumed_images"), 8);
  EXPECT_EQ(fs::last_write_time(image), written) << "left as it was";
  EXPECT_EQ(cut.files(), whole.files());
}

TEST(Resume, ImagesOfAnotherJobAreRenderedAgain) {
  AJob job, other;
  api::JobReport report;
  ASSERT_FALSE(job.run(report, 0.3));
  // The same folder, another job: what is seen is brighter.
  for (AJob* each : {&job, &other}) {
    each->input.with("animation.json", "another job");
    each->request.images[0].auto_exposure = false;
    each->request.images[0].exposure_stops = 3;
  }
  report = {};
  ASSERT_TRUE(job.run(report));
  EXPECT_EQ(count_of(report, "resumed_images"), 0);
  api::JobReport ignored;
  ASSERT_TRUE(other.run(ignored));
  EXPECT_EQ(job.files(), other.files());
}

TEST(Resume, AFingerprintIsThatOfNamesAndBytes) {
  SceneFolder a, b;
  a.with("scene.obj", "v 0 0 0").with("animation.json", "{}");
  b.with("scene.obj", "v 0 0 0").with("animation.json", "{}");
  EXPECT_EQ(*job_fingerprint(a.path()), *job_fingerprint(b.path()));
  b.with("animation.json", "{ }");
  EXPECT_NE(*job_fingerprint(a.path()), *job_fingerprint(b.path()));
  b.with("animation.json", "{}").with("wood.png", "");
  EXPECT_NE(*job_fingerprint(a.path()), *job_fingerprint(b.path()));
}

TEST(Resume, ASolutionComesBackAsItWasSaved) {
  const tests::TemporaryFolder temporary;
  SolvedSequence solved;
  solved.radiosity_w_m2 = PatchSeries(2, 3);
  for (std::size_t k = 0; k < 6; ++k) solved.radiosity_w_m2.values[k] = {0.1f * static_cast<float>(k), 1, 2};
  solved.others = {{"radiosity_se.npy", PatchSeries(2, 3)}, {"radiosity_left.npy", PatchSeries(2, 3)}};
  solved.others[1].values_w_m2.values[5] = {7, 8, 9};
  solved.key_frames.mode = api::LightingMode::paper;
  solved.key_frames.frames = {
      {0, api::FrameKind::key, 0.0}, {1, {}, 1.0 / 3}, {2, api::FrameKind::check, {}}};
  solved.key_frames.intervals = {{0, 2, 0.1, 1e-17}};
  api::JobReport report;
  report.warnings = {"it is dark"};
  report.counts = {{"lines", 5}};
  report.noise = 0.01;
  Checkpoints checkpoints(temporary.path() / "checkpoint", "job");
  ASSERT_TRUE(save_solved(solved, report, checkpoints));

  api::JobReport later;
  later.stage_seconds = {{api::Stage::scene, 0.5}};
  const auto loaded = load_solved(checkpoints, later);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->radiosity_w_m2.values, solved.radiosity_w_m2.values);
  EXPECT_EQ(loaded->radiosity_w_m2.frame_count, 3u);
  ASSERT_EQ(loaded->others.size(), 2u);
  EXPECT_EQ(loaded->others[1].file, "radiosity_left.npy");
  EXPECT_EQ(loaded->others[1].values_w_m2.values, solved.others[1].values_w_m2.values);
  EXPECT_EQ(api::key_frame_report_json(loaded->key_frames), api::key_frame_report_json(solved.key_frames));
  EXPECT_EQ(later.warnings, report.warnings);
  EXPECT_EQ(later.counts, report.counts);
  EXPECT_EQ(later.noise, report.noise);
  ASSERT_EQ(later.stage_seconds.size(), 1u) << "the time of this attempt";
  EXPECT_FALSE(load_solved(Checkpoints(temporary.path() / "checkpoint", "another"), later));
}

}  // namespace
}  // namespace engine
