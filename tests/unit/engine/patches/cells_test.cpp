#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/sobol.h"
#include "engine/patches/patches.h"

namespace engine {
namespace {

Facet grid(bool is_triangle, std::uint32_t grid_u, std::uint32_t grid_v) {
  Facet facet;
  facet.is_triangle = is_triangle;
  facet.grid_u = grid_u;
  facet.grid_v = grid_v;
  return facet;
}

/// Twice the signed area in (u, v).
double doubled_area(const CellCorners& cell) {
  double area = 0;
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    const std::uint32_t next = (k + 1) % cell.count;
    area += double{cell.u[k]} * cell.v[next] - double{cell.u[next]} * cell.v[k];
  }
  return area;
}

/// Every cell holds its own centre, turns counter-clockwise and has its share of the area.
void expect_cells_fit(const Facet& facet) {
  const double share = (facet.is_triangle ? 1.0 : 2.0) / facet.cell_count();
  double total = 0;
  for (std::uint32_t k = 0; k < facet.cell_count(); ++k) {
    const CellCorners cell = cell_corners(facet, k);
    ASSERT_EQ(cell.count, facet.is_triangle ? 3u : 4u);
    float u = 0, v = 0;
    for (std::uint32_t c = 0; c < cell.count; ++c) {
      u += cell.u[c] / static_cast<float>(cell.count);
      v += cell.v[c] / static_cast<float>(cell.count);
    }
    ASSERT_EQ(cell_at(facet, u, v), k) << facet.grid_u << " x " << facet.grid_v;
    const double area = doubled_area(cell);
    EXPECT_NEAR(area, share, 1e-6) << k;
    total += area;
  }
  EXPECT_NEAR(total, facet.is_triangle ? 1.0 : 2.0, 1e-5);
}

TEST(Cells, ParallelogramCellsHoldTheirOwnCentresAndShareTheArea) {
  for (const std::uint32_t n : {1u, 2u, 3u, 7u, 64u})
    for (const std::uint32_t m : {1u, 5u, 33u}) expect_cells_fit(grid(false, n, m));
}

TEST(Cells, TriangleCellsHoldTheirOwnCentresAndShareTheArea) {
  for (const std::uint32_t n : {1u, 2u, 3u, 7u, 64u, 101u}) expect_cells_fit(grid(true, n, n));
}

TEST(Cells, ParallelogramsCountAlongUFirst) {
  const Facet facet = grid(false, 3, 2);
  EXPECT_EQ(cell_at(facet, 0.1f, 0.1f), 0u);
  EXPECT_EQ(cell_at(facet, 0.9f, 0.1f), 2u);
  EXPECT_EQ(cell_at(facet, 0.1f, 0.9f), 3u);
}

TEST(Cells, TrianglesCountRowByRowUprightAndInvertedInTurn) {
  const Facet facet = grid(true, 3, 3);
  EXPECT_EQ(cell_at(facet, 0.1f, 0.1f), 0u);
  EXPECT_EQ(cell_at(facet, 0.25f, 0.25f), 1u);  // the first row's first inverted one
  EXPECT_EQ(cell_at(facet, 0.9f, 0.05f), 4u);
  EXPECT_EQ(cell_at(facet, 0.1f, 0.4f), 5u);  // the second row begins at j (2 n - j) = 5
  EXPECT_EQ(cell_at(facet, 0.05f, 0.9f), 8u);
}

/// Is (u, v) in the cell, or within rounding of its border?
bool holds(const CellCorners& cell, double u, double v) {
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    const std::uint32_t next = (k + 1) % cell.count;
    const double turn = (double{cell.u[next]} - cell.u[k]) * (v - cell.v[k]) -
                        (double{cell.v[next]} - cell.v[k]) * (u - cell.u[k]);
    if (turn < -1e-6) return false;
  }
  return true;
}

TEST(Cells, RowsOfATriangleBeginAndEndWhereTheyShouldHoweverManyThereAre) {
  for (const std::uint32_t n : {1u, 2u, 3u, 7u, 1000u, 4096u, 4472u}) {
    const Facet facet = grid(true, n, n);
    for (std::uint32_t row = 0; row < n; ++row) {
      const float v = static_cast<float>(row) * (1.0f / static_cast<float>(n));
      const CellCorners first = cell_corners(facet, row * (2 * n - row));
      const CellCorners last = cell_corners(facet, (row + 1) * (2 * n - row - 1) - 1);
      ASSERT_EQ(first.v[0], v) << n << ' ' << row;
      ASSERT_EQ(first.u[0], 0) << n << ' ' << row;
      ASSERT_EQ(last.v[0], v) << n << ' ' << row;
      ASSERT_NEAR(last.u[1] + last.v[1], 1, 1e-5) << n << ' ' << row;
    }
  }
}

TEST(Cells, APointIsInTheCellThatIsFoundForIt) {
  for (const Facet& facet : {grid(false, 5, 3), grid(false, 17, 40), grid(true, 4, 4), grid(true, 29, 29)})
    for (std::uint32_t k = 0; k < 5'000; ++k) {
      auto [u, v, a, b] = owen_sobol(k, 5);
      if (facet.is_triangle && u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const std::uint32_t cell = cell_at(facet, u, v);
      ASSERT_LT(cell, facet.cell_count());
      ASSERT_TRUE(holds(cell_corners(facet, cell), u, v)) << u << ", " << v << " cell " << cell;
    }
}

TEST(Cells, PointsOnAndALittleBeyondTheEdgesBelongToTheNearestCell) {
  for (const float off : {0.0f, 1e-6f, 1e-3f}) {
    const Facet square = grid(false, 4, 3);
    EXPECT_EQ(cell_at(square, -off, -off), 0u);
    EXPECT_EQ(cell_at(square, 1 + off, -off), 3u);
    EXPECT_EQ(cell_at(square, 1 + off, 1 + off), 11u);
    const Facet triangle = grid(true, 4, 4);
    EXPECT_EQ(cell_at(triangle, -off, -off), 0u);
    EXPECT_EQ(cell_at(triangle, 1 + off, -off), 6u);
    EXPECT_EQ(cell_at(triangle, -off, 1 + off), 15u);
    for (int k = 1; k < 20; ++k) {  // the long edge: upright cells, the last of their rows
      const float u = static_cast<float>(k) / 20 + off, v = 1 - static_cast<float>(k) / 20 + off;
      const std::uint32_t cell = cell_at(triangle, u, v);
      EXPECT_TRUE(cell == 6 || cell == 11 || cell == 14 || cell == 15) << u << ": " << cell;
    }
  }
}

}  // namespace
}  // namespace engine
