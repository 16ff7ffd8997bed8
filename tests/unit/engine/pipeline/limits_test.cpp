#include "engine/pipeline/limits.h"

#include <gtest/gtest.h>

#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

using api::Fault;

/// The pointers of the violations, one per line.
template <class T>
std::string refused_at(const api::Result<T>& result) {
  if (result) return "accepted";
  EXPECT_EQ(result.error().fault, Fault::out_of_resources);
  EXPECT_FALSE(result.error().message.empty());
  std::string pointers;
  for (const api::Violation& v : result.error().violations) {
    EXPECT_EQ(v.file, "animation.json");
    EXPECT_EQ(v.code, "limit_exceeded");
    pointers += (pointers.empty() ? "" : " ") + v.pointer;
  }
  return pointers;
}

api::JobRequest job_of(std::uint32_t frames) {
  api::JobRequest request;
  request.frame_count = frames;
  return request;
}

/// A square of 1000 m: (1000 / edge)^2 patches.
Scene field() {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {1000, 0, 0}, {1000, 1000, 0}, {0, 1000, 0}});
  return scene;
}

/// Of the field, the first `blinking` of its four lamps each with a curve of its own.
Animation lamps(std::uint32_t frames, std::uint32_t blinking = 0) {
  Animation animation = tests::still(field(), frames);
  for (std::uint32_t k = 0; k < 4; ++k) {
    SourceMotion lamp{
        "lamp" + std::to_string(k), api::LightType::point, {{}}, {{0, 0, -1}}, {{1, 1, 1}}, 1, 1};
    if (k < blinking)
      for (FrameIndex f = 1; f < frames; ++f)
        lamp.intensity.push_back(Rgb{1, 1, 1} * (1.0f / static_cast<float>(1 + (f + k) % 7)));
    animation.emission.sources.push_back(lamp);
  }
  return animation;
}

api::Result<MeshSizes> size_of(const api::JobRequest& request, std::uint32_t blinking = 0) {
  return check_mesh_size(request, field(), lamps(request.frame_count, blinking));
}

TEST(RequestSize, ADefaultJobIsAccepted) {
  EXPECT_EQ(refused_at(check_request_size(job_of(2000), 3)), "accepted");
}

TEST(RequestSize, LinesHaveNoLimitButTheirSchemas) {
  auto request = job_of(1);
  request.lighting.line_count = 1'000'000'000;
  EXPECT_EQ(refused_at(check_request_size(request, 1)), "accepted");
}

TEST(RequestSize, PosesOfObjectsAndCamerasAreCountedInAllFrames) {
  auto request = job_of(2000);
  EXPECT_EQ(refused_at(check_request_size(request, 5000)), "accepted");
  EXPECT_EQ(refused_at(check_request_size(request, 10'000)), "/objects");
  request.scene.cameras["one more"] = {};
  EXPECT_EQ(refused_at(check_request_size(request, 5000)), "/objects");
}

TEST(RequestSize, SamplesOfAllImagesAreAddedAndTheLargestImageIsNamed) {
  auto request = job_of(100);
  request.images.resize(2);
  for (auto& image : request.images) image.width = image.height = 8000;
  request.images[0].samples_per_pixel = 15;
  request.images[1].samples_per_pixel = 16;
  EXPECT_EQ(refused_at(check_request_size(request, 1)), "accepted");  // 31 x 6.4e9 = 1.984e11
  request.images[1].samples_per_pixel = 17;
  EXPECT_EQ(refused_at(check_request_size(request, 1)), "/images/1");
}

TEST(RequestSize, EveryLimitThatIsExceededIsNamed) {
  auto request = job_of(2000);
  request.images.resize(1);
  request.images[0].width = request.images[0].height = 8192;
  EXPECT_EQ(refused_at(check_request_size(request, 100'000)), "/objects /images/0");
}

TEST(MeshSize, PatchesTimesFramesAreRefusedBeyondTheMemoryOfASeries) {
  auto request = job_of(100);
  request.lighting.patch_edge_m = 1;  // 1,000,000 patches x 100 frames x 12 bytes x 10 series = 11.2 GiB
  request.lighting.estimate_patch_edge_m = 100;
  const auto count = size_of(request);
  EXPECT_EQ(refused_at(count), "accepted");
  EXPECT_EQ(count->fine.patches, 1'000'000u);
  request.lighting.light_groups = {{"lamps", {"lamp0"}}};  // 16 series
  EXPECT_EQ(refused_at(size_of(request)), "/lighting/patch_edge_m");
  request.lighting.light_groups.clear();
  request.frame_count = 108;  // 12.07 GiB
  EXPECT_EQ(refused_at(size_of(request)), "/lighting/patch_edge_m");
}

// Each curve of brightness is a solution, three of them at most, where only indirect light is interpolated.
TEST(MeshSize, LampsThatBlinkOnTheirOwnAreSolutionsMore) {
  auto request = job_of(100);
  request.lighting.patch_edge_m = 100;
  request.lighting.estimate_patch_edge_m = 1.3;  // 592,900 patches x 100 frames x 12 bytes: .663 GiB
  EXPECT_EQ(refused_at(size_of(request)), "accepted") << "17 of these are 11.3 GiB";
  EXPECT_EQ(refused_at(size_of(request, 1)), "/lighting/estimate_patch_edge_m") << "27 are 17.9 GiB";
  request.lighting.interpolated = api::Interpolated::total;
  EXPECT_EQ(refused_at(size_of(request, 1)), "accepted");
  request.lighting.interpolated = api::Interpolated::indirect;
  request.lighting.estimate_patch_edge_m = 100;
  request.lighting.patch_edge_m = 1.1;  // 828,100 patches: .925 GiB each
  EXPECT_EQ(refused_at(size_of(request)), "accepted") << "10 of these are 9.3 GiB";
  EXPECT_EQ(refused_at(size_of(request, 1)), "/lighting/patch_edge_m") << "14 are 13 GiB";
}

TEST(MeshSize, SeriesOfTheEstimateAreThoseThatItHolds) {
  api::LightingOptions lighting;
  EXPECT_EQ(series_of_estimate(lighting, 1), 17u);  // B, direct, 9 compared, a window's 6
  EXPECT_EQ(series_of_estimate(lighting, 4), 47u);
  EXPECT_EQ(series_of_estimate(lighting, 8), 90u);  // 8 + 1 of weights, when the windows' are gone
  lighting.interpolated = api::Interpolated::total;
  EXPECT_EQ(series_of_estimate(lighting, 4), 20u);
  lighting.mode = api::LightingMode::paper;
  EXPECT_EQ(series_of_estimate(lighting, 1), 8u);
}

TEST(MeshSize, TheEstimatesMeshHasALimitOfItsOwnWhereTheModeHasAnEstimate) {
  auto request = job_of(100);
  request.lighting.patch_edge_m = 100;
  request.lighting.estimate_patch_edge_m = 1;
  EXPECT_EQ(refused_at(size_of(request)), "/lighting/estimate_patch_edge_m");
  request.lighting.mode = api::LightingMode::reference;
  EXPECT_EQ(refused_at(size_of(request)), "accepted");
}

TEST(MeshSize, AMeshOfATrillionPatchesIsRefusedWithoutMakingIt) {
  auto request = job_of(1);
  request.lighting.patch_edge_m = 1e-3;
  EXPECT_EQ(refused_at(size_of(request)), "/lighting/patch_edge_m");
}

// Coarse edges of 2 m: 500 x 500 cells, each of them 64 patches at most.
TEST(MeshSize, TheAdaptiveLayoutIsRefusedWhereItsCoarsestMeshIsMoreThanAskedFor) {
  auto request = job_of(1);
  request.lighting.patch_layout = api::PatchLayout::adaptive;
  request.lighting.patch_edge_m = 1;
  request.lighting.patch_count_max = 249'999;
  request.lighting.estimate_patch_edge_m = 100;
  EXPECT_EQ(refused_at(size_of(request)), "/lighting/patch_count_max");
  request.lighting.patch_count_max = 250'000;
  EXPECT_EQ(refused_at(size_of(request)), "accepted");
}

TEST(MeshSize, TheAdaptiveLayoutCountsTheMostItCanComeTo) {
  auto request = job_of(1);
  request.lighting.patch_layout = api::PatchLayout::adaptive;
  request.lighting.patch_edge_m = 10;
  request.lighting.patch_count_max = 30'000;
  request.lighting.estimate_patch_edge_m = 100;
  EXPECT_EQ(size_of(request)->fine.patches, 30'000u);
  request.lighting.patch_count_max = 1'000'000;
  EXPECT_EQ(size_of(request)->fine.patches, 160'000u);  // all of them of 2.5 m
  request.frame_count = 10'000;                         // 12 GiB of 10 x 12 bytes each
  EXPECT_EQ(size_of(request)->fine.patches, 10'737u);
  EXPECT_EQ(patch_budget(request, field(), lamps(request.frame_count)), 10'737u);
}

}  // namespace
}  // namespace engine
