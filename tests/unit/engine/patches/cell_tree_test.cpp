#include "engine/patches/cell_tree.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "engine/patches/grade.h"
#include "engine/patches/patches.h"
#include "tests/unit/engine/patches/random_trees.h"

namespace engine {
namespace {

/// Twice the signed area on the lattice.
std::int64_t doubled_area(const LeafCorners& leaf) {
  std::int64_t area = 0;
  for (std::uint32_t k = 0; k < leaf.count; ++k) {
    const LatticePoint a = leaf.at[k], b = leaf.at[(k + 1) % leaf.count];
    area += std::int64_t{a.i} * b.j - std::int64_t{b.i} * a.j;
  }
  return area;
}

/// Is (u, v) in the cell, or within `slack` of its border?
bool holds(const CellCorners& cell, double u, double v, double slack) {
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    const std::uint32_t next = (k + 1) % cell.count;
    const double turn = (double{cell.u[next]} - cell.u[k]) * (v - cell.v[k]) -
                        (double{cell.v[next]} - cell.v[k]) * (u - cell.u[k]);
    if (turn < -slack) return false;
  }
  return true;
}

TEST(CellTree, AWholeCellIsOneLeafOfAllSlots) {
  const CellTree tree;
  EXPECT_EQ(tree.leaf_count(), 1u);
  EXPECT_EQ(leaf_of(tree, 0).slots, 64u);
  for (std::uint32_t slot = 0; slot < 64; ++slot) EXPECT_EQ(tree.leaf_at(slot), 0u);
}

TEST(CellTree, QuarteringTwiceGivesThreeLargeAndFourSmallLeaves) {
  CellTree tree;
  tree.first_leaf = 10;
  tree.leaf_starts |= quartered({0, 64});
  tree.leaf_starts |= quartered({16, 16});
  ASSERT_EQ(tree.leaf_count(), 7u);
  const std::pair<std::uint32_t, std::uint32_t> expected[] = {{0, 16}, {16, 4},  {20, 4}, {24, 4},
                                                              {28, 4}, {32, 16}, {48, 16}};
  for (std::uint32_t k = 0; k < 7; ++k) {
    EXPECT_EQ(leaf_of(tree, k).first, expected[k].first) << k;
    EXPECT_EQ(leaf_of(tree, k).slots, expected[k].second) << k;
  }
  EXPECT_EQ(tree.leaf_at(0), 10u);
  EXPECT_EQ(tree.leaf_at(15), 10u);
  EXPECT_EQ(tree.leaf_at(23), 12u);
  EXPECT_EQ(tree.leaf_at(63), 16u);
}

TEST(CellTree, SlotsAndCornersOfSquaresAgree) {
  std::set<std::uint32_t> seen;
  for (std::uint32_t j = 0; j < 8; ++j)
    for (std::uint32_t i = 0; i < 8; ++i) {
      const std::uint32_t slot = square_slot(i, j);
      seen.insert(slot);
      const LeafCorners corners = square_leaf_corners({80, 40}, {slot, 1});
      EXPECT_EQ(corners.at[0], (LatticePoint{80 + i, 40 + j}));
      EXPECT_EQ(corners.at[2], (LatticePoint{81 + i, 41 + j}));
    }
  EXPECT_EQ(seen.size(), 64u);
}

// An upright lattice triangle has its right angle at (i, j), an inverted one at (i + 1, j + 1).
TEST(CellTree, SlotsAndCornersOfTrianglesAgree) {
  std::set<std::uint32_t> seen;
  for (std::uint32_t j = 0; j < 8; ++j)
    for (std::uint32_t i = 0; i + j < 8; ++i)
      for (const bool inverted : {false, true}) {
        if (inverted && i + j == 7) continue;
        const std::uint32_t slot = triangle_slot(i, j, inverted);
        ASSERT_LT(slot, 64u);
        seen.insert(slot);
        const LeafCorners corners = triangle_leaf_corners({0, 0}, false, {slot, 1});
        EXPECT_EQ(doubled_area(corners), 1);
        std::uint32_t sum_i = 0, sum_j = 0;
        for (const LatticePoint at : {corners.at[0], corners.at[1], corners.at[2]}) {
          sum_i += at.i;
          sum_j += at.j;
        }
        EXPECT_EQ(sum_i, 3 * i + (inverted ? 2 : 1)) << i << ' ' << j << inverted;
        EXPECT_EQ(sum_j, 3 * j + (inverted ? 2 : 1)) << i << ' ' << j << inverted;
      }
  EXPECT_EQ(seen.size(), 64u);
}

TEST(CellTree, QuartersTurnCounterClockwiseAndHaveAQuarterOfTheArea) {
  for (const bool inverted : {false, true})
    for (std::uint32_t slots = 64, area = 64; slots > 0; slots /= 4, area /= 4)
      for (std::uint32_t first = 0; first < 64; first += slots) {
        EXPECT_EQ(doubled_area(triangle_leaf_corners({16, 24}, inverted, {first, slots})), area);
        EXPECT_EQ(doubled_area(square_leaf_corners({16, 24}, {first, slots})), 2 * area);
      }
}

// At every level: the cell found for a point has the point between its corners, and is found for the middle
// of those corners.
TEST(CellTree, PointToCellToCornersRoundTripOnRandomFacets) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::uniform_int_distribution<std::uint32_t> parts(1, 9);
  std::set<std::uint32_t> sizes;
  for (int round = 0; round < 60; ++round) {
    Patches patches = tests::one_facet(round % 2 == 0, parts(random), parts(random));
    tests::quarter_at_random(patches, 3, 0.6, random);
    const Facet& facet = patches.facets[0];
    for (int k = 0; k < 400; ++k) {
      float u = uniform(random), v = uniform(random);
      if (facet.is_triangle && u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const std::uint32_t cell = cell_at(facet, u, v);
      ASSERT_LT(cell, facet.cell_count());
      ASSERT_TRUE(holds(cell_corners(facet, cell), u, v, 1e-6)) << u << ' ' << v << ' ' << cell;
    }
    for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
      const CellCorners corners = cell_corners(facet, cell);
      float u = 0, v = 0;
      for (std::uint32_t c = 0; c < corners.count; ++c) {
        u += corners.u[c] / static_cast<float>(corners.count);
        v += corners.v[c] / static_cast<float>(corners.count);
      }
      ASSERT_EQ(cell_at(facet, u, v), cell);
      if (!facet.trees.empty())
        sizes.insert(static_cast<std::uint32_t>(std::abs(doubled_area(leaf_corners(facet, cell)))));
    }
  }
  for (const std::uint32_t doubled : {1u, 4u, 16u, 64u, 2u, 8u, 32u, 128u})
    EXPECT_TRUE(sizes.contains(doubled)) << "no leaf of this size was tested: " << doubled;
}

TEST(CellTree, PointsBeyondTheRimBelongToACellOnIt) {
  std::mt19937 random(3);
  for (const bool is_triangle : {false, true}) {
    Patches patches = tests::one_facet(is_triangle, 3, 5);
    tests::quarter_at_random(patches, 3, 0.7, random);
    const Facet& facet = patches.facets[0];
    for (const float off : {0.0f, 1e-6f, 1e-3f})
      for (int k = 0; k <= 20; ++k) {
        const float t = static_cast<float>(k) / 20, far = is_triangle ? 1 - t : 1;
        for (const auto& [u, v] : {std::pair{-off, t}, {t, -off}, {far + off, t + (is_triangle ? off : 0)}}) {
          const std::uint32_t cell = cell_at(facet, u, v);
          ASSERT_LT(cell, facet.cell_count());
          EXPECT_TRUE(holds(cell_corners(facet, cell), u, v, 3 * off + 1e-6)) << u << ' ' << v;
        }
      }
  }
}

TEST(NumberPatches, TreesThatQuarterNothingLeaveTheMeshAsItWas) {
  Patches patches = tests::one_facet(true, 4, 4);
  const Patches before = patches;
  patches.facets[0].trees.resize(16);
  number_patches(patches);
  EXPECT_TRUE(patches.facets[0].trees.empty());
  EXPECT_EQ(patches.facet_of, before.facet_of);
  EXPECT_EQ(patches.area_m2, before.area_m2);
}

/// The largest ratio of sizes of two cells with a common edge: looked up beyond points all along it.
std::uint32_t largest_ratio(const Facet& facet) {
  const auto size = [&](std::uint32_t cell) {
    const LeafCorners leaf = leaf_corners(facet, cell);
    return std::max(leaf.at[0].i, leaf.at[1].i) - std::min(leaf.at[0].i, leaf.at[1].i);
  };
  std::uint32_t largest = 1;
  for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
    const CellCorners corners = cell_corners(facet, cell);
    float u = 0, v = 0;
    for (std::uint32_t c = 0; c < corners.count; ++c) {
      u += corners.u[c] / static_cast<float>(corners.count);
      v += corners.v[c] / static_cast<float>(corners.count);
    }
    for (std::uint32_t c = 0; c < corners.count; ++c)
      for (const float t : {0.06f, 0.3f, 0.45f, 0.7f, 0.94f}) {
        const std::uint32_t next = (c + 1) % corners.count;
        const float edge_u = corners.u[c] + t * (corners.u[next] - corners.u[c]);
        const float edge_v = corners.v[c] + t * (corners.v[next] - corners.v[c]);
        const float out_u = edge_u + 0.01f * (edge_u - u), out_v = edge_v + 0.01f * (edge_v - v);
        if (out_u < 0 || out_v < 0 || (facet.is_triangle ? out_u + out_v : std::max(out_u, out_v)) > 1)
          continue;
        largest = std::max(largest, size(cell_at(facet, out_u, out_v)) / size(cell));
      }
  }
  return largest;
}

TEST(Grade, NeighboursDifferByOneHalvingAtMostAndNothingIsJoined) {
  std::mt19937 random(5);
  std::uint32_t before_largest = 1;
  for (int round = 0; round < 40; ++round) {
    Patches patches = tests::one_facet(round % 2 == 0, 4, 3);
    tests::quarter_at_random(patches, 3, 0.4, random);
    Facet& facet = patches.facets[0];
    if (facet.trees.empty()) continue;
    const std::vector<CellTree> before = facet.trees;
    before_largest = std::max(before_largest, largest_ratio(facet));
    grade(facet);
    number_patches(patches);
    EXPECT_LE(largest_ratio(patches.facets[0]), 2u);
    for (std::size_t cell = 0; cell < before.size(); ++cell)
      EXPECT_EQ(before[cell].leaf_starts & ~facet.trees[cell].leaf_starts, 0u);
  }
  EXPECT_EQ(before_largest, 8u) << "nothing had to be done";
}

}  // namespace
}  // namespace engine
