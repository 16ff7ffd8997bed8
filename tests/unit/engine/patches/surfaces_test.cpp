// Surfaces of every kind, whole and quartered: each point of a polygon belongs to exactly one patch.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "engine/patches/ear_clipping.h"
#include "tests/unit/engine/patches/random_trees.h"

namespace engine {
namespace {

using tests::add_polygon;
using tests::scene_with;

Vec3 at(const Facet& facet, float u, float v) {
  return facet.origin + u * facet.edge_u + v * facet.edge_v;
}

/// (u, v) of the foot of `p` on the facet's plane.
std::pair<float, float> coordinates(const Facet& facet, Vec3 p) {
  const Vec3 offset = p - facet.origin, u = facet.edge_u, v = facet.edge_v;
  const float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ou = dot(offset, u), ov = dot(offset, v);
  const float determinant = uu * vv - uv * uv;
  return {(ou * vv - ov * uv) / determinant, (ov * uu - ou * uv) / determinant};
}

/// Smallest distance to the borders of the cell, in lengths of its edges; < 0 outside.
float depth_in(const CellCorners& cell, float u, float v) {
  float depth = 1;
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    const std::uint32_t next = (k + 1) % cell.count;
    const float du = cell.u[next] - cell.u[k], dv = cell.v[next] - cell.v[k];
    depth = std::min(depth, (du * (v - cell.v[k]) - dv * (u - cell.u[k])) / (du * du + dv * dv));
  }
  return depth;
}

/// The patches of `polygon` (fronts) that hold `p`; `near_border` if rounding may decide that.
std::vector<PatchId> holders(const Patches& patches, std::uint32_t polygon, Vec3 p, bool& near_border) {
  std::vector<PatchId> found;
  near_border = false;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    if (facet.polygon != polygon) continue;
    const auto [u, v] = coordinates(facet, p);
    if (length(at(facet, u, v) - p) > 1e-4f) continue;  // the other half of a bent quad
    for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
      const float depth = depth_in(cell_corners(facet, cell), u, v);
      near_border = near_border || std::abs(depth) < 1e-3f;
      if (depth < 0) continue;
      found.push_back(facet.first_patch + cell);
      EXPECT_EQ(patches.patch_at(f, u, v, true), facet.first_patch + cell);
    }
  }
  return found;
}

/// Points of the polygons, uniform on their triangles: each in one patch, and the areas add up.
void expect_partition(const Scene& scene, const Patches& patches, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  int tested = 0;
  double area_m2 = 0;
  for (std::uint32_t polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    std::vector<Vec3> corners;
    for (std::uint32_t c = 0; c < scene.polygons[polygon].corner_count; ++c)
      corners.push_back(scene.vertices[scene.corners[scene.polygons[polygon].first_corner + c]]);
    for (const auto& [a, b, c] : clip_ears(corners)) {
      const Vec3 u = corners[b] - corners[a], v = corners[c] - corners[a];
      area_m2 += 0.5 * length(cross(u, v)) * (scene.materials[0].both_sides ? 2 : 1);
      for (int k = 0; k < 40; ++k) {
        float s = uniform(random), t = uniform(random);
        if (s + t > 1) s = 1 - s, t = 1 - t;
        const Vec3 p = corners[a] + s * u + t * v;
        bool near_border = false;
        const auto found = holders(patches, polygon, p, near_border);
        if (near_border) continue;
        ++tested;
        ASSERT_EQ(found.size(), 1u) << "polygon " << polygon << " at " << p.x << ' ' << p.y << ' ' << p.z;
      }
    }
  }
  EXPECT_GT(tested, 20);
  double sum = 0;
  for (const float of_patch : patches.area_m2) sum += of_patch;
  EXPECT_NEAR(sum, area_m2, 1e-5 * area_m2);
}

/// Each patch's area is that of its corners.
void expect_areas(const Patches& patches) {
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    const Facet& facet = patches.facets[patches.facet_of[patch]];
    const CellCorners cell = cell_corners(facet, patches.cell_of(patch));
    std::vector<Vec3> corners;
    for (std::uint32_t c = 0; c < cell.count; ++c) corners.push_back(at(facet, cell.u[c], cell.v[c]));
    ASSERT_NEAR(length(area_vector(corners)), patches.area_m2[patch], 1e-4f * patches.area_m2[patch] + 1e-7f);
  }
}

void expect_sound(const Scene& scene) {
  std::mt19937 random(11);
  for (const double edge_m : {0.33, 5.0})
    for (const std::uint32_t levels : {0u, 1u, 2u, 3u}) {
      auto patches = mesh_into_patches(scene, {edge_m, api::PatchLayout::adaptive});
      ASSERT_TRUE(patches);
      if (levels > 0) tests::quarter_at_random(*patches, levels, 0.5, random);
      expect_partition(scene, *patches, random);
      expect_areas(*patches);
    }
}

TEST(Surfaces, ATriangleAndAParallelogram) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {2, 0, 0}, {0.5f, 1.5f, 1}});
  add_polygon(scene, {{1, 2, 3}, {4, 2, 3}, {5, 4, 3}, {2, 4, 3}});
  expect_sound(scene);
}

TEST(Surfaces, AClosedAndAnOpenMesh) {
  Scene closed = scene_with(1, 1);
  tests::add_box(closed, {0, 0, 0}, {1, 2, 0.5f}, false);
  expect_sound(closed);
  Scene open = scene_with(1, 1, true);
  add_polygon(open, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  add_polygon(open, {{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}});
  expect_sound(open);
}

TEST(Surfaces, ConcavePolygons) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}});  // L
  add_polygon(scene, {{0, 0, 3}, {4, 1, 3}, {0, 2, 3}, {1, 1, 3}});                        // dart
  add_polygon(scene,
              {{0, 5, 0}, {3, 5, 0}, {3, 5, 3}, {2, 5, 3}, {2, 5, 1}, {1, 5, 1}, {1, 5, 3}, {0, 5, 3}});  // U
  expect_sound(scene);
}

TEST(Surfaces, ABentQuadIsTwoTrianglesThatShareTheirDiagonal) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {2, 0, 0}, {2, 2, 1}, {0, 2, 0}});
  const auto patches = mesh_into_patches(scene, 10);
  ASSERT_EQ(patches->facets.size(), 2u);
  int shared = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      shared += patches->facets[0].corners[a] == patches->facets[1].corners[b];
  EXPECT_EQ(shared, 2);
  expect_sound(scene);
}

TEST(Surfaces, CoplanarFacesThatTouch) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  add_polygon(scene, {{1, 0, 0}, {2, 0, 0}, {2, 0.5f, 0}, {1, 0.5f, 0}});  // half an edge
  add_polygon(scene, {{1, 0.5f, 0}, {2, 0.5f, 0}, {1.5f, 1.5f, 0}});
  expect_sound(scene);
}

TEST(Surfaces, FrontsComeFirstAndBacksFollowInTheSameOrder) {
  Scene scene = scene_with(1, 1, true);
  add_polygon(scene, {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}});
  auto patches = *mesh_into_patches(scene, 1.0);
  std::mt19937 random(1);
  tests::quarter_at_random(patches, 3, 0.6, random);
  const Facet& facet = patches.facets[0];
  ASSERT_EQ(patches.count(), 2 * facet.cell_count());
  ASSERT_GT(facet.cell_count(), facet.grid_cells());
  for (PatchId p = 0; p < patches.count(); ++p) {
    EXPECT_EQ(patches.is_back(p), p >= facet.cell_count());
    EXPECT_EQ(patches.area_m2[p], patches.area_m2[patches.cell_of(p)]);
  }
  for (float u = 0.01f; u < 1; u += 0.03f)
    EXPECT_EQ(patches.patch_at(0, u, 0.4f, false), patches.patch_at(0, u, 0.4f, true) + facet.cell_count());
}

// Cells of 0.5 m are twice 0.25 m, and eight times a quarter of that.
TEST(AdaptiveMesh, BeginsCoarseAndSaysHowOftenCellsMayBeQuartered) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}});
  add_polygon(scene, {{0, 0, 1}, {1.2f, 0, 1}, {0, 1.2f, 1}});
  const auto patches = mesh_into_patches(scene, {0.25, api::PatchLayout::adaptive});
  ASSERT_TRUE(patches);
  EXPECT_EQ(patches->facets[0].grid_u, 6u);
  EXPECT_EQ(patches->facets[0].grid_v, 4u);
  EXPECT_EQ(levels_of(patches->facets[0], 0.25), 3u);
  EXPECT_EQ(patches->facets[1].grid_u, 4u);            // 1.7 m in parts of 0.42
  EXPECT_EQ(levels_of(patches->facets[1], 0.25), 3u);  // 0.053 m: two would leave 0.106
  EXPECT_EQ(levels_of(patches->facets[0], 1.0), 1u);   // halves are a quarter of 1 m
  EXPECT_EQ(levels_of(patches->facets[0], 3.0), 0u);
  const auto count = count_patches(scene, {0.25, api::PatchLayout::adaptive});
  EXPECT_EQ(count->patches, patches->count());
  EXPECT_EQ(count->finest, 64u * patches->count());
}

TEST(AdaptiveMesh, LongThinFacetsAreCutAlongTheirLengthAtFirst) {
  Scene scene = scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {2, 0, 0}, {2, 0.05f, 0}, {0, 0.05f, 0}});
  add_polygon(scene, {{0, 0, 1}, {2, 0, 1}, {2, 0.2f, 1}, {0, 0.2f, 1}});
  const auto patches = mesh_into_patches(scene, {0.25, api::PatchLayout::adaptive});
  EXPECT_EQ(patches->facets[0].grid_u, 8u);  // of 0.25 m, as in the uniform layout
  EXPECT_EQ(patches->facets[0].grid_v, 1u);
  EXPECT_EQ(patches->facets[1].grid_u, 5u);  // of twice 0.2 m
}

}  // namespace
}  // namespace engine
