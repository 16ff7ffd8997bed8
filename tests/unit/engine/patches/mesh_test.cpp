#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>

#include "api/job_request.h"
#include "engine/patches/patches.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

using tests::add_polygon;
using tests::scene_with;

Patches mesh(const Scene& scene, double patch_edge_m) {
  auto patches = mesh_into_patches(scene, patch_edge_m);
  EXPECT_TRUE(patches) << patches.error().message;
  return patches ? std::move(*patches) : Patches{};
}

double total_area_m2(const Patches& patches) {
  return std::accumulate(patches.area_m2.begin(), patches.area_m2.end(), 0.0);
}

// The count is that of the garage's definition: 30 x 18 x 4 m, 15 lights, a plane of four boxes, every edge
// cut into ceil(edge / sqrt(0.035) m).
TEST(MeshIntoPatches, TheGarageCutsInto43630Patches) {
  const auto folder = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples/garage";
  std::ifstream file(folder / "animation.json", std::ios::binary);
  const auto request = api::parse_job_request(std::string{std::istreambuf_iterator<char>(file), {}});
  ASSERT_TRUE(request) << request.error().message;
  const auto scene = load_scene(folder, request->scene);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh(*scene, std::sqrt(0.035)).count(), 43'630u);
  EXPECT_EQ(mesh(*scene, 2.0).count(), 413u);
}

TEST(MeshIntoPatches, AParallelogramStaysWholeAndItsCellsShareItsArea) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{1, 2, 3}, {4, 2, 3}, {5, 4, 3}, {2, 4, 3}});
  const Patches patches = mesh(scene, 0.7);
  ASSERT_EQ(patches.facets.size(), 1u);
  const Facet& facet = patches.facets[0];
  EXPECT_FALSE(facet.is_triangle);
  EXPECT_EQ(facet.grid_u, 5u);  // 3 m
  EXPECT_EQ(facet.grid_v, 4u);  // sqrt(5) m
  EXPECT_EQ(patches.count(), 20u);
  EXPECT_EQ(facet.normal, (Vec3{0, 0, 1}));
  for (const float area : patches.area_m2) EXPECT_FLOAT_EQ(area, 6.0f / 20);
}

TEST(MeshIntoPatches, AnEdgeThatTheLengthDividesIsNotCutOnceMore) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {30, 0, 0}, {30, 18, 0}, {0, 18, 0}});
  const Patches patches = mesh(scene, 0.1875);
  EXPECT_EQ(patches.facets[0].grid_u, 160u);
  EXPECT_EQ(patches.facets[0].grid_v, 96u);
}

TEST(MeshIntoPatches, ATriangleIsCutByItsLongestEdge) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}});
  const Patches patches = mesh(scene, 1.0);
  ASSERT_EQ(patches.facets.size(), 1u);
  EXPECT_EQ(patches.facets[0].grid_u, 5u);
  EXPECT_EQ(patches.count(), 25u);
  EXPECT_NEAR(total_area_m2(patches), 6.0, 1e-5);
}

TEST(MeshIntoPatches, ABothSidedFacetHasItsFrontsFirstAndThenItsBacks) {
  Scene scene = scene_with(1, 2);
  scene.materials[1].both_sides = true;
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0, 0);
  add_polygon(scene, {{0, 0, 1}, {3, 0, 1}, {3, 2, 1}, {0, 2, 1}}, 0, 1);
  const Patches patches = mesh(scene, 1.0);
  ASSERT_EQ(patches.count(), 1u + 12u);
  EXPECT_FALSE(patches.is_back(0));
  for (PatchId p = 1; p < 13; ++p) {
    EXPECT_EQ(patches.facet_of[p], 1u);
    EXPECT_EQ(patches.is_back(p), p >= 7) << p;
    EXPECT_EQ(patches.cell_of(p), (p - 1) % 6) << p;
  }
  EXPECT_EQ(patches.patch_at(1, 0.5f, 0.75f, true), 1u + 4u);
  EXPECT_EQ(patches.patch_at(1, 0.5f, 0.75f, false), 7u + 4u);
  EXPECT_EQ(patches.patch_at(0, 0.5f, 0.5f, true), 0u);
  EXPECT_EQ(patches.patch_at(0, 0.5f, 0.5f, false), kNoPatch);
}

TEST(MeshIntoPatches, AQuadThatIsNoParallelogramBecomesTwoTrianglesOfItsArea) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 2}, {4, 0, 2}, {3, 2, 2}, {1, 2, 2}});
  const Patches patches = mesh(scene, 10);
  ASSERT_EQ(patches.facets.size(), 2u);
  for (const Facet& facet : patches.facets) {
    EXPECT_TRUE(facet.is_triangle);
    EXPECT_EQ(facet.polygon, 0u);
    EXPECT_FLOAT_EQ(facet.normal.z, 1);
  }
  EXPECT_NEAR(total_area_m2(patches), 6.0, 1e-6);
}

TEST(MeshIntoPatches, FacetsWithoutAreaAreDroppedAndTheRestKeepTheirPolygons) {
  Scene scene = scene_with(2, 1);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});                         // three in a row
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}});              // a doubled edge
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 1);           // a square
  add_polygon(scene, {{1e3f, 0, 0}, {1e3f, 0, 0}, {1e3f, 0, 0}, {1e3f, 0, 0}});  // a point
  const Patches patches = mesh(scene, 1.0);
  ASSERT_EQ(patches.count(), 1u);
  EXPECT_EQ(patches.facets[0].polygon, 2u);
  EXPECT_EQ(patches.facets[0].object, 1u);
  EXPECT_EQ(patches.dropped_facets, 3u);  // the quads are parallelograms: a facet each
}

TEST(CountPatches, IsWhatTheMeshThenHas) {
  Scene scene = scene_with(1, 1, true);
  add_polygon(scene, {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}});
  add_polygon(scene, {{0, 0, 2}, {4, 0, 2}, {3, 2, 2}, {1, 2, 2}});
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  for (const double edge_m : {0.1, 0.7, 5.0}) {
    const auto count = count_patches(scene, edge_m);
    ASSERT_TRUE(count);
    EXPECT_EQ(count->patches, mesh(scene, edge_m).count()) << edge_m;
    EXPECT_EQ(count->dropped_facets, 1u);
  }
}

TEST(CountPatches, GoesOnBeyondWhatAMeshMayHold) {
  Scene scene = scene_with(1, 1);
  for (int k = 0; k < 2000; ++k) add_polygon(scene, {{0, 0, 0}, {1e6f, 0, 0}, {1e6f, 1e6f, 0}, {0, 1e6f, 0}});
  EXPECT_EQ(count_patches(scene, 1e3)->patches, 2'000'000'000u);
  EXPECT_EQ(count_patches(scene, 1.0)->patches, 1'000'000'000'000'000u);  // held: it would overflow some day
}

TEST(MeshIntoPatches, ASceneWithoutAreaIsRefused) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  const auto patches = mesh_into_patches(scene, 1.0);
  ASSERT_FALSE(patches);
  EXPECT_EQ(patches.error().fault, api::Fault::invalid_request);
}

// 4,500 x 4,500 cells are more than 20 million, within 32 bits; 10^6 x 10^6 are not within them. None may
// cost memory before it is refused.
TEST(MeshIntoPatches, MoreThanTheLargestNumberOfPatchesIsOutOfResources) {
  for (const double edge_m : {4500.0, 1e6, 1e9}) {
    Scene scene = scene_with(1, 1);
    const auto e = static_cast<float>(edge_m);
    add_polygon(scene, {{0, 0, 0}, {e, 0, 0}, {e, e, 0}, {0, e, 0}});
    const auto patches = mesh_into_patches(scene, 1.0);
    ASSERT_FALSE(patches) << edge_m;
    EXPECT_EQ(patches.error().fault, api::Fault::out_of_resources);
    EXPECT_NE(patches.error().message.find("patch_edge_m"), std::string::npos);
  }
}

TEST(MeshIntoPatches, BothSidesCountTowardsTheLimit) {
  for (const bool both : {false, true}) {
    Scene scene = scene_with(1, 1, both);
    add_polygon(scene, {{0, 0, 0}, {3400, 0, 0}, {3400, 3400, 0}, {0, 3400, 0}});  // 11.56 million
    EXPECT_EQ(bool(mesh_into_patches(scene, 1.0)), !both);
  }
}

}  // namespace
}  // namespace engine
