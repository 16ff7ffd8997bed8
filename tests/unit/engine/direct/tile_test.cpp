// Tiles hold every patch once, whatever is asked for, and neighbours together.
#include "engine/direct/tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "tests/unit/engine/moving_room.h"
#include "tests/unit/engine/patches/random_trees.h"

namespace engine {
namespace {

using tests::World;

/// A room of parallelograms with both sides, a triangle, and a facet of one cell.
Patches some_patches(double edge_m) {
  Scene scene = tests::room_with_things(true);
  tests::add_polygon(scene, {{0, 0, 1}, {1.3f, 0, 1}, {0.2f, 1.1f, 1}});
  tests::add_polygon(scene, {{0, 0, 1.5f}, {0.01f, 0, 1.5f}, {0.01f, 0.01f, 1.5f}, {0, 0.01f, 1.5f}});
  return *mesh_into_patches(scene, edge_m);
}

/// How often each patch is in a tile.
std::map<PatchId, int> held(const Patches& patches, PatchId first, PatchId end, std::uint32_t cells_max) {
  std::vector<Tile> tiles;
  add_tiles(patches, first, end, cells_max, tiles);
  std::map<PatchId, int> count;
  TileLayout layout;
  for (const Tile& tile : tiles) {
    lay_out(patches, tile, layout);
    EXPECT_EQ(layout.patches.size(), tile.count);
    EXPECT_LE(tile.count, cells_max);
    for (const PatchId patch : layout.patches) ++count[patch];
  }
  return count;
}

void expect_each_once(const Patches& patches) {
  for (const std::uint32_t cells : {64u, 16u, 1u}) {
    const auto all = held(patches, 0, patches.count(), cells);
    EXPECT_EQ(all.size(), patches.count());
    for (const auto& [patch, count] : all) ASSERT_EQ(count, 1) << patch;
    const PatchId first = patches.count() / 3, end = 2 * patches.count() / 3;
    const auto some = held(patches, first, end, cells);
    for (PatchId patch = first; patch < end; ++patch) ASSERT_EQ(some.count(patch), 1u) << patch;
    for (const auto& [patch, count] : some) ASSERT_EQ(count, 1) << patch;
  }
}

TEST(Tiles, HoldEveryPatchOfARangeOnce) {
  for (const double edge : {0.03, 0.11, 5.0}) expect_each_once(some_patches(edge));
}

TEST(Tiles, HoldEveryLeafOfQuarteredCellsOnce) {
  Patches patches = some_patches(0.2);
  std::mt19937 random(7);
  tests::quarter_at_random(patches, 3, 0.4, random);
  ASSERT_TRUE(std::any_of(patches.facets.begin(), patches.facets.end(),
                          [](const Facet& facet) { return !facet.trees.empty(); }));
  expect_each_once(patches);
}

TEST(Tiles, AreTheSameForEveryRangeThatMeetsThem) {
  const Patches patches = some_patches(0.05);
  std::vector<Tile> all, some;
  add_tiles(patches, 0, patches.count(), 64, all);
  add_tiles(patches, 700, 1900, 64, some);
  for (const Tile& tile : some)
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Tile& other) {
      return tile.facet == other.facet && tile.back == other.back && tile.column == other.column &&
             tile.row == other.row && tile.side == other.side && tile.first == other.first;
    }));
  EXPECT_LT(some.size(), all.size());
}

TEST(Tiles, HaveNodesThatHoldTheirCells) {
  for (const double edge : {0.03, 0.11}) {
    const Patches patches = some_patches(edge);
    std::vector<Tile> tiles;
    add_tiles(patches, 0, patches.count(), 64, tiles);
    TileLayout layout;
    for (const Tile& tile : tiles) {
      lay_out(patches, tile, layout);
      std::size_t leaves = 0;
      ASSERT_EQ(layout.nodes[0].end, layout.patches.size());
      for (std::size_t n = 0; n < layout.nodes.size(); ++n) {
        const TileNode& node = layout.nodes[n];
        leaves += node.end - node.first == 1 ? 1 : 0;
        std::uint32_t next = node.first;  // children one after the other
        for (std::size_t child = n + 1; child < node.beyond; child = layout.nodes[child].beyond) {
          ASSERT_EQ(layout.nodes[child].first, next);
          next = layout.nodes[child].end;
        }
        if (node.end - node.first > 1) {
          ASSERT_EQ(next, node.end);
        }
        for (std::uint32_t k = node.first; k < node.end; ++k)
          for (std::uint32_t c = 0; c < layout.cells[k].count; ++c) {
            ASSERT_TRUE(node.u0 <= layout.cells[k].u[c] && layout.cells[k].u[c] <= node.u1);
            ASSERT_TRUE(node.v0 <= layout.cells[k].v[c] && layout.cells[k].v[c] <= node.v1);
          }
      }
      EXPECT_EQ(leaves, layout.patches.size());
    }
  }
}

TEST(Tiles, OfAWholeSquareAreQuarteredIntoSquares) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
  const Patches patches = *mesh_into_patches(scene, 0.25);
  std::vector<Tile> tiles;
  add_tiles(patches, 0, patches.count(), 64, tiles);
  ASSERT_EQ(tiles.size(), 1u);
  TileLayout layout;
  lay_out(patches, tiles[0], layout);
  ASSERT_EQ(layout.nodes.size(), 1u + 4 + 16 + 64);
  for (const TileNode& node : layout.nodes) {
    EXPECT_NEAR(node.u1 - node.u0, node.v1 - node.v0, 1e-6);
    EXPECT_NEAR((node.u1 - node.u0) * (node.v1 - node.v0) * 64, node.end - node.first, 1e-4);
  }
}

}  // namespace
}  // namespace engine
