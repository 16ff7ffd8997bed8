// The three patches of figure 4 are where the room's generator puts the cubes and the wing.
#include <gtest/gtest.h>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_plan.h"
#include "engine/bench/bench_scene.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

const std::filesystem::path kExamples = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples";

TEST(RoomProbes, LieOnTheCubesAndTheWing) {
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(write_bench_job(bench_plan({})[2].full, kExamples, folder.path()));
  const auto room = load_bench_scene(folder.path() / "input");
  ASSERT_TRUE(room) << room.error().message;
  const auto probes = find_probes(*room);
  ASSERT_TRUE(probes) << probes.error().message;
  const char* const materials[] = {"red_cube", "green_cube", "plane"};
  const Vec3 normals[] = {{0, 0, 1}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k) {
    const Facet& facet = room->patches.facets[room->patches.facet_of[(*probes)[k]]];
    EXPECT_EQ(room->scene.materials[facet.material].name, materials[k]);
    EXPECT_GT(dot(facet.normal, normals[k]), 0.999f) << kProbeNames[k];
  }
}

TEST(RoomProbes, AreNotFoundElsewhere) {
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(write_bench_job(bench_plan({})[0].full, kExamples, folder.path()));
  const auto garage = load_bench_scene(folder.path() / "input");
  ASSERT_TRUE(garage);
  EXPECT_FALSE(find_probes(*garage));
}

// A patch that emits has no weight in any error; the others have their areas.
TEST(PatchWeights, AreAreasOfWhatDoesNotEmit) {
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(write_bench_job(bench_plan({})[2].full, kExamples, folder.path()));
  const auto room = load_bench_scene(folder.path() / "input");
  ASSERT_TRUE(room);
  double left_out = 0, sum = 0;
  const PatchWeights weights = patch_weights(*room);
  for (PatchId patch = 0; patch < room->patches.count(); ++patch) {
    sum += room->patches.area_m2[patch];
    left_out += room->patches.area_m2[patch] - weights[patch];
  }
  EXPECT_NEAR(left_out, 1.2 * 1.2, 1e-5);
  EXPECT_GT(sum, 2 * (8 * 6 + 8 * 3.2 + 6 * 3.2));
}

}  // namespace
}  // namespace engine
