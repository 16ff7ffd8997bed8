// A job is checked as it is run: both refuse the same, before anything expensive.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "engine/pipeline/run_pipeline.h"
#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

/// A square metre "lamp", and a strip so thin that the polygon has an area, but neither of its two facets.
const std::string kScene = kSquare +
                           "v 0 0 5\nv 1 0 5\nv 0.999 1.6e-7 5\nv 0 1.6e-7 5\n"
                           "o lamp\nf 1 2 3 4\no rest\nf 5 6 7 8\n";

struct AJob {
  SceneFolder folder;
  api::JobRequest request;
  api::JobReport report;

  AJob() {
    folder.with("scene.obj", kScene);
    request.scene.allow_dark = true;
    request.frame_count = 2;
    request.lighting.patch_edge_m = 0.5;
  }
  api::Status check() { return check_job(request, folder.path(), 1, report); }
  api::Status run() { return run_pipeline(request, folder.path(), folder.path(), {}, report); }
};

double count_of(const api::JobReport& report, std::string_view name) {
  for (const auto& [key, value] : report.counts)
    if (key == name) return value;
  return -1;
}

TEST(CheckJob, CountsWhatARunWouldHave) {
  AJob job;
  ASSERT_TRUE(job.check());
  EXPECT_EQ(count_of(job.report, "patches"), 8);  // four cells, both sides
  EXPECT_EQ(count_of(job.report, "frames"), 2);
  const api::JobReport checked = std::exchange(job.report, {});
  ASSERT_TRUE(job.run());
  EXPECT_EQ(count_of(job.report, "patches"), count_of(checked, "patches"));
  EXPECT_EQ(job.report.warnings, checked.warnings);
}

TEST(CheckJob, WarnsOfFacetsThatAreLeftOut) {
  AJob job;
  ASSERT_TRUE(job.check());
  const auto tells = [](const std::string& warning) { return warning.find("2 slivers") != warning.npos; };
  EXPECT_EQ(std::count_if(job.report.warnings.begin(), job.report.warnings.end(), tells), 1);
}

TEST(CheckJob, RefusesATranslationThatFloatsCannotHold) {
  AJob job;
  job.request.scene.metres_per_unit = 1e6;
  api::ObjectAnimation& lamp = job.request.scene.objects["lamp"];
  lamp.translate.keys = {{0, {0, 0, 0}}, {1, {1e9, 0, 0}}};
  for (const auto& status : {job.check(), job.run()}) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().fault, api::Fault::invalid_request);
    EXPECT_EQ(places_of(status.error()), "animation.json /objects/lamp out_of_range\n");
  }
}

TEST(CheckJob, ARunRefusesWhatACheckRefuses) {
  AJob job;
  job.request.lighting.patch_edge_m = 1e-4;
  for (const auto& status : {job.check(), job.run()}) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().fault, api::Fault::out_of_resources);
    EXPECT_EQ(places_of(status.error()), "animation.json /lighting/patch_edge_m limit_exceeded\n");
  }
}

}  // namespace
}  // namespace engine
