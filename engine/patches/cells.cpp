#include <algorithm>
#include <cmath>

#include "engine/patches/grade.h"
#include "engine/patches/patches.h"

namespace engine {
namespace {

/// A cell of a triangle that is cut into n rows.
struct TriangleCell {
  std::uint32_t column = 0, row = 0;
  bool inverted = false;

  std::uint32_t number(std::uint32_t n) const {
    return row * (2 * n - row) + 2 * column + (inverted ? 1 : 0);
  }
};

TriangleCell triangle_cell_at(std::uint32_t n, float u, float v) {
  const std::uint32_t row = index_in_grid(v, n);
  const std::uint32_t column = std::min(index_in_grid(u, n), n - 1 - row);
  const float in_cell = (u + v) * static_cast<float>(n) - static_cast<float>(column + row);
  return {column, row, in_cell > 1.0f && column + row + 1 < n};
}

/// Row j starts at j (2 n - j) <= cell, so that j = floor(n - sqrt(n^2 - cell)), but for rounding.
TriangleCell triangle_cell_numbered(std::uint32_t n, std::uint32_t cell) {
  const double beyond = static_cast<double>(n) * n - cell;
  auto row = static_cast<std::uint32_t>(n - std::sqrt(beyond));
  while (row * (2 * n - row) > cell) --row;
  while ((row + 1) * (2 * n - row - 1) <= cell) ++row;
  const std::uint32_t in_row = cell - row * (2 * n - row);
  return {in_row / 2, row, in_row % 2 == 1};
}

CellCorners triangle_cell_corners(std::uint32_t n, std::uint32_t cell) {
  const TriangleCell at = triangle_cell_numbered(n, cell);
  const float step = 1.0f / static_cast<float>(n);
  const float u = static_cast<float>(at.column) * step, v = static_cast<float>(at.row) * step;
  if (!at.inverted) return {3, {u, u + step, u, 0}, {v, v, v + step, 0}};
  return {3, {u + step, u + step, u, 0}, {v, v + step, v + step, 0}};
}

}  // namespace

// The grid cell of a cell of the lattice is a division by kLatticeParts.
LatticeSlot slot_at(const Facet& facet, float u, float v) {
  constexpr std::uint32_t n = kLatticeParts;
  if (!facet.is_triangle) {
    const std::uint32_t i = index_in_grid(u, facet.grid_u * n), j = index_in_grid(v, facet.grid_v * n);
    return {j / n * facet.grid_u + i / n, square_slot(i % n, j % n)};
  }
  const TriangleCell at = triangle_cell_at(facet.grid_u * n, u, v);
  const std::uint32_t i = at.column % n, j = at.row % n;
  const bool inverted = i + j + (at.inverted ? 1 : 0) >= n;
  return {TriangleCell{at.column / n, at.row / n, inverted}.number(facet.grid_u),
          inverted ? triangle_slot(n - 1 - i, n - 1 - j, !at.inverted) : triangle_slot(i, j, at.inverted)};
}

std::uint32_t cell_at(const Facet& facet, float u, float v) {
  if (!facet.trees.empty()) {
    const LatticeSlot at = slot_at(facet, u, v);
    return facet.trees[at.grid_cell].leaf_at(at.slot);
  }
  if (facet.is_triangle) return triangle_cell_at(facet.grid_u, u, v).number(facet.grid_u);
  return index_in_grid(v, facet.grid_v) * facet.grid_u + index_in_grid(u, facet.grid_u);
}

LeafCorners leaf_corners(const Facet& facet, std::uint32_t grid_cell, Leaf leaf) {
  constexpr std::uint32_t n = kLatticeParts;
  if (!facet.is_triangle)
    return square_leaf_corners({grid_cell % facet.grid_u * n, grid_cell / facet.grid_u * n}, leaf);
  const TriangleCell at = triangle_cell_numbered(facet.grid_u, grid_cell);
  return triangle_leaf_corners({at.column * n, at.row * n}, at.inverted, leaf);
}

LeafCorners leaf_corners(const Facet& facet, std::uint32_t cell) {
  const auto after =
      std::upper_bound(facet.trees.begin(), facet.trees.end(), cell,
                       [](std::uint32_t k, const CellTree& tree) { return k < tree.first_leaf; });
  const auto tree = std::prev(after);
  return leaf_corners(facet, static_cast<std::uint32_t>(tree - facet.trees.begin()),
                      leaf_of(*tree, cell - tree->first_leaf));
}

CellCorners cell_corners(const Facet& facet, std::uint32_t cell) {
  const auto at = [](std::uint32_t k, std::uint32_t n) {
    return static_cast<float>(k) / static_cast<float>(n);
  };
  if (!facet.trees.empty()) {
    const LeafCorners leaf = leaf_corners(facet, cell);
    CellCorners corners{leaf.count, {}, {}};
    for (std::uint32_t c = 0; c < leaf.count; ++c) {
      corners.u[c] = at(leaf.at[c].i, facet.grid_u * kLatticeParts);
      corners.v[c] = at(leaf.at[c].j, facet.grid_v * kLatticeParts);
    }
    return corners;
  }
  if (facet.is_triangle) return triangle_cell_corners(facet.grid_u, cell);
  const std::uint32_t i = cell % facet.grid_u, j = cell / facet.grid_u;
  const float u0 = at(i, facet.grid_u), u1 = at(i + 1, facet.grid_u);
  const float v0 = at(j, facet.grid_v), v1 = at(j + 1, facet.grid_v);
  return {4, {u0, u1, u1, u0}, {v0, v0, v1, v1}};
}

PatchId Patches::patch_at(std::uint32_t facet_index, float u, float v, bool front) const {
  const Facet& facet = facets[facet_index];
  if (!front && !facet.both_sides) return kNoPatch;
  return facet.first_patch + (front ? 0 : facet.cell_count()) + cell_at(facet, u, v);
}

}  // namespace engine
