#include <algorithm>

#include "engine/patches/patches.h"

namespace engine {
namespace {

/// floor(x n), clamped to the grid: hits on the far edge belong to the last cell.
std::uint32_t index_in(float x, std::uint32_t n) {
  const float scaled = x * static_cast<float>(n);
  return scaled <= 0 ? 0 : std::min(static_cast<std::uint32_t>(scaled), n - 1);
}

std::uint32_t triangle_cell_at(std::uint32_t n, float u, float v) {
  const std::uint32_t row = index_in(v, n);
  const std::uint32_t column = std::min(index_in(u, n), n - 1 - row);
  const float in_cell = (u + v) * static_cast<float>(n) - static_cast<float>(column + row);
  const bool inverted = in_cell > 1.0f && column + row + 1 < n;
  return row * (2 * n - row) + 2 * column + (inverted ? 1 : 0);
}

CellCorners triangle_cell_corners(std::uint32_t n, std::uint32_t cell) {
  std::uint32_t row = 0;
  while ((row + 1) * (2 * n - row - 1) <= cell) ++row;
  const std::uint32_t in_row = cell - row * (2 * n - row);
  const float step = 1.0f / static_cast<float>(n);
  const float u = static_cast<float>(in_row / 2) * step, v = static_cast<float>(row) * step;
  if (in_row % 2 == 0) return {3, {u, u + step, u, 0}, {v, v, v + step, 0}};
  return {3, {u + step, u + step, u, 0}, {v, v + step, v + step, 0}};
}

}  // namespace

std::uint32_t cell_at(const Facet& facet, float u, float v) {
  if (facet.is_triangle) return triangle_cell_at(facet.grid_u, u, v);
  return index_in(v, facet.grid_v) * facet.grid_u + index_in(u, facet.grid_u);
}

CellCorners cell_corners(const Facet& facet, std::uint32_t cell) {
  if (facet.is_triangle) return triangle_cell_corners(facet.grid_u, cell);
  const std::uint32_t i = cell % facet.grid_u, j = cell / facet.grid_u;
  const auto at = [](std::uint32_t k, std::uint32_t n) {
    return static_cast<float>(k) / static_cast<float>(n);
  };
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
