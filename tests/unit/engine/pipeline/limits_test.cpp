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
  const auto count = check_mesh_size(request, field());
  EXPECT_EQ(refused_at(count), "accepted");
  EXPECT_EQ(count->fine.patches, 1'000'000u);
  request.lighting.light_groups = {{"lamps", {"lamp"}}};  // 16 series
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "/lighting/patch_edge_m");
  request.lighting.light_groups.clear();
  request.frame_count = 108;  // 12.07 GiB
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "/lighting/patch_edge_m");
}

TEST(MeshSize, TheEstimatesMeshHasALimitOfItsOwnWhereTheModeHasAnEstimate) {
  auto request = job_of(100);
  request.lighting.patch_edge_m = 100;
  request.lighting.estimate_patch_edge_m = 1;
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "/lighting/estimate_patch_edge_m");
  request.lighting.mode = api::LightingMode::reference;
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "accepted");
}

TEST(MeshSize, AMeshOfATrillionPatchesIsRefusedWithoutMakingIt) {
  auto request = job_of(1);
  request.lighting.patch_edge_m = 1e-3;
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "/lighting/patch_edge_m");
}

// Coarse edges of 2 m: 500 x 500 cells, each of them 64 patches at most.
TEST(MeshSize, TheAdaptiveLayoutIsRefusedWhereItsCoarsestMeshIsMoreThanAskedFor) {
  auto request = job_of(1);
  request.lighting.patch_layout = api::PatchLayout::adaptive;
  request.lighting.patch_edge_m = 1;
  request.lighting.patch_count_max = 249'999;
  request.lighting.estimate_patch_edge_m = 100;
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "/lighting/patch_count_max");
  request.lighting.patch_count_max = 250'000;
  EXPECT_EQ(refused_at(check_mesh_size(request, field())), "accepted");
}

TEST(MeshSize, TheAdaptiveLayoutCountsTheMostItCanComeTo) {
  auto request = job_of(1);
  request.lighting.patch_layout = api::PatchLayout::adaptive;
  request.lighting.patch_edge_m = 10;
  request.lighting.patch_count_max = 30'000;
  request.lighting.estimate_patch_edge_m = 100;
  EXPECT_EQ(check_mesh_size(request, field())->fine.patches, 30'000u);
  request.lighting.patch_count_max = 1'000'000;
  EXPECT_EQ(check_mesh_size(request, field())->fine.patches, 160'000u);  // all of them of 2.5 m
  request.frame_count = 10'000;                                          // 12 GiB of 10 x 12 bytes each
  EXPECT_EQ(check_mesh_size(request, field())->fine.patches, 10'737u);
  EXPECT_EQ(patch_budget(request), 10'737u);
}

}  // namespace
}  // namespace engine
