#include "engine/image/node_rows.h"

#include <gtest/gtest.h>

#include "engine/image/shown_surfaces.h"
#include "tests/unit/engine/patches/random_trees.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

struct Shown {
  Scene scene;
  Animation animation;
  Patches patches;
  ShownSurfaces surfaces;

  Shown(Scene of_scene, Patches of_patches)
      : scene(std::move(of_scene)), animation(tests::still(scene, 1)), patches(std::move(of_patches)) {
    surfaces = shown_surfaces(scene, patches, animation, StaticRays(patches, animation));
  }
};

/// Neighbours have nothing to do with each other: a wrong patch or weight shows.
PatchSeries rough(const Patches& patches) {
  return tests::series_of(patches, 1, [](PatchId patch, Vec3 p) {
    return Rgb{0.1f + static_cast<float>(patch * 2654435761u % 1000u) / 100, static_cast<float>(patch % 7),
               1 + std::abs(p.x)};
  });
}

/// As values_of_nodes() in render_images.cpp has them for pictures.
std::vector<Rgb> pictured(const Shown& shown, const PatchSeries& series) {
  std::vector<std::vector<Rgb>> values(1);
  node_radiosity(
      shown.surfaces.mesh, shown.patches, series, 0, [] { return false; }, values);
  show_uncovered(
      shown.surfaces.uncovered, shown.surfaces.mesh, shown.patches, series, 0,
      [](PatchId) {
        return Rgb{1, 1, 1};
      },
      values);
  return values[0];
}

void expect_rows_give_the_pictured_values(const Shown& shown) {
  const PatchSeries series = rough(shown.patches);
  const std::vector<Rgb> expected = pictured(shown, series);
  const NodeRows rows(shown.surfaces.mesh, shown.patches, shown.surfaces.uncovered);
  ASSERT_EQ(rows.node_count(), expected.size());
  for (std::uint32_t node = 0; node < rows.node_count(); ++node) {
    std::vector<PatchWeight> row;
    rows.append(node, row);
    ASSERT_EQ(row.size(), rows.size_of(node));
    Rgb sum;
    for (const PatchWeight part : row) sum += part.weight * series.at(part.patch, 0);
    ASSERT_NEAR(sum.r, expected[node].r, 1e-5f * expected[node].r) << "node " << node;
    ASSERT_NEAR(sum.g, expected[node].g, 1e-5f * (1 + expected[node].g)) << "node " << node;
    ASSERT_NEAR(sum.b, expected[node].b, 1e-5f * expected[node].b) << "node " << node;
  }
}

/// A square, a pentagon (its triangles cut their common edges differently), both sides.
Scene floor_plan() {
  Scene scene = tests::scene_with(1, 1, true);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  tests::add_polygon(scene, {{1, 0, 0}, {2, -0.2f, 0}, {2.3f, 0.5f, 0}, {1.9f, 1.1f, 0}, {1, 1, 0}});
  return scene;
}

TEST(NodeRows, GiveThePicturedValuesOfPlainGrids) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_box(scene, {0, 0, 0}, {1, 2, 3}, true);
  expect_rows_give_the_pictured_values(Shown(scene, *mesh_into_patches(scene, 0.3)));
}

TEST(NodeRows, GiveThePicturedValuesAlongSeams) {
  const Shown shown(floor_plan(), *mesh_into_patches(floor_plan(), 0.1));
  ASSERT_FALSE(shown.surfaces.mesh.seams.empty());
  expect_rows_give_the_pictured_values(shown);
}

TEST(NodeRows, GiveThePicturedValuesOfNodesThatHang) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Patches patches = *mesh_into_patches(floor_plan(), 0.25);
    std::mt19937 random(seed);
    tests::quarter_at_random(patches, 3, 0.5, random);
    const Shown shown(floor_plan(), patches);
    ASSERT_FALSE(shown.surfaces.mesh.hanging.empty());
    ASSERT_FALSE(shown.surfaces.mesh.seams.empty());
    expect_rows_give_the_pictured_values(shown);
  }
}

TEST(NodeRows, GiveThePicturedValuesAroundWhatStandsOnAFloor) {
  Scene scene = tests::scene_with(2, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}});
  tests::add_box(scene, {2.5f, 2.5f, 0}, {4, 4, 1}, false, 1);
  for (const bool quartered : {false, true}) {
    Patches patches = *mesh_into_patches(scene, 1);
    std::mt19937 random(1);
    if (quartered) tests::quarter_at_random(patches, 2, 0.5, random);
    const Shown shown(scene, patches);
    ASSERT_FALSE(shown.surfaces.uncovered.nodes.empty());
    expect_rows_give_the_pictured_values(shown);
  }
}

Vec3 corner_of(const Facet& facet, const CellCorners& corners, std::uint32_t c) {
  return facet.origin + corners.u[c] * facet.edge_u + corners.v[c] * facet.edge_v;
}

// The corners of every patch by its nodes: at the same points in the same turn, and seen from its own side.
void expect_patches_lie_between_their_nodes(const Patches& patches) {
  const ShadingMesh mesh = build_shading_mesh(patches);
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    const Facet& facet = patches.facets[patches.facet_of[patch]];
    const CellCorners corners = cell_corners(facet, patches.cell_of(patch));
    const PatchNodes nodes = nodes_of_patch(mesh, patches, patch);
    ASSERT_EQ(nodes.count, corners.count);
    Vec3 at[4];
    for (std::uint32_t k = 0; k < nodes.count; ++k) {
      at[k] = position_of_node(mesh, patches, nodes.node[k]);
      const std::uint32_t c = patches.is_back(patch) ? nodes.count - 1 - k : k;
      ASSERT_LT(length(at[k] - corner_of(facet, corners, c)), 1e-6f) << "patch " << patch << " corner " << k;
    }
    const Vec3 outward = cross(at[1] - at[0], at[nodes.count - 1] - at[0]);
    ASSERT_GT(dot(outward, patches.is_back(patch) ? -facet.normal : facet.normal), 0) << patch;
  }
}

TEST(NodesOfPatch, AreItsCornersInOrder) {
  Patches patches = *mesh_into_patches(floor_plan(), 0.1);
  expect_patches_lie_between_their_nodes(patches);
  std::mt19937 random(7);
  tests::quarter_at_random(patches, 3, 0.5, random);
  expect_patches_lie_between_their_nodes(patches);
}

// The blend that pictures take inside a cell is between these very nodes.
TEST(NodesOfPatch, AreThoseThatPicturesBlend) {
  Patches patches = *mesh_into_patches(floor_plan(), 0.3);
  std::mt19937 random(3);
  for (const bool quartered : {false, true}) {
    if (quartered) tests::quarter_at_random(patches, 2, 0.5, random);
    const ShadingMesh mesh = build_shading_mesh(patches);
    for (PatchId patch = 0; patch < patches.count(); ++patch) {
      const std::uint32_t f = patches.facet_of[patch];
      const CellCorners corners = cell_corners(patches.facets[f], patches.cell_of(patch));
      float u = 0, v = 0;
      for (std::uint32_t c = 0; c < corners.count; ++c)
        u += corners.u[c] / static_cast<float>(corners.count),
            v += corners.v[c] / static_cast<float>(corners.count);
      const NodeBlend blend = blend_at(mesh, patches, f, u, v, !patches.is_back(patch));
      std::vector<std::uint32_t> blended, listed;
      for (std::uint32_t c = 0; c < blend.count; ++c) blended.push_back(blend.nodes[c].node);
      const PatchNodes nodes = nodes_of_patch(mesh, patches, patch);
      listed.assign(nodes.node.begin(), nodes.node.begin() + nodes.count);
      std::sort(blended.begin(), blended.end());
      std::sort(listed.begin(), listed.end());
      EXPECT_EQ(blended, listed) << "patch " << patch;
    }
  }
}

}  // namespace
}  // namespace engine
