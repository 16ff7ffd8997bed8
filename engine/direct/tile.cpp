#include "engine/direct/tile.h"

#include <algorithm>
#include <limits>

namespace engine {
namespace {

/// Squares that facets are cut into at first: a power of two.
constexpr std::uint32_t kSide = 8;

/// A square of positions on the grid of a facet.
struct Square {
  std::uint32_t column = 0, row = 0, side = 1;
};

/// The grid of a facet; a position of a triangle has an upright cell and mostly an inverted one.
struct Grid {
  const Facet& facet;

  bool holds(std::uint32_t column, std::uint32_t row) const {
    if (facet.is_triangle) return column + row < facet.grid_u;
    return column < facet.grid_u && row < facet.grid_v;
  }
  std::uint32_t rows() const { return facet.is_triangle ? facet.grid_u : facet.grid_v; }
  std::uint32_t columns() const { return facet.grid_u; }

  std::uint32_t grid_cell(std::uint32_t column, std::uint32_t row) const {
    if (facet.is_triangle) return row * (2 * facet.grid_u - row) + 2 * column;
    return row * facet.grid_u + column;
  }
  /// At a position.
  std::uint32_t grid_cells(std::uint32_t column, std::uint32_t row) const {
    return facet.is_triangle && column + row + 1 < facet.grid_u ? 2 : 1;
  }
  std::uint32_t first_cell(std::uint32_t grid_cell) const {
    if (facet.trees.empty()) return grid_cell;
    return grid_cell < facet.trees.size() ? facet.trees[grid_cell].first_leaf : facet.cell_count();
  }
  std::uint32_t first_in_row(std::uint32_t row) const {
    return row < rows() ? first_cell(grid_cell(0, row)) : facet.cell_count();
  }

  /// Calls use(first cell, end) for the positions of a square, quarter by quarter.
  template <class Use>
  void each_position(const Square& square, Use&& use) const {
    if (!holds(square.column, square.row)) return;  // nor is there anything farther out
    if (square.side == 1) {
      const std::uint32_t at = grid_cell(square.column, square.row);
      use(first_cell(at), first_cell(at + grid_cells(square.column, square.row)));
      return;
    }
    for (std::uint32_t quarter = 0; quarter < 4; ++quarter) each_position(quarter_of(square, quarter), use);
  }

  static Square quarter_of(const Square& square, std::uint32_t quarter) {
    const std::uint32_t half = square.side / 2;
    return {square.column + quarter % 2 * half, square.row + quarter / 2 * half, half};
  }
};

/// Where the cells of a facet's side that are asked for end and begin.
struct CellRange {
  std::uint32_t first = 0, end = 0;
};

void add_squares(const Grid& grid, const Square& square, std::uint32_t cells_max, const CellRange& asked,
                 Tile tile, std::vector<Tile>& tiles) {
  std::uint32_t count = 0, lowest = std::numeric_limits<std::uint32_t>::max(), end = 0;
  grid.each_position(square, [&](std::uint32_t first_cell, std::uint32_t end_cell) {
    count += end_cell - first_cell;
    lowest = std::min(lowest, first_cell);
    end = std::max(end, end_cell);
  });
  if (count == 0 || end <= asked.first || asked.end <= lowest) return;
  if (count > cells_max && square.side > 1) {
    for (std::uint32_t quarter = 0; quarter < 4; ++quarter)
      add_squares(grid, Grid::quarter_of(square, quarter), cells_max, asked, tile, tiles);
    return;
  }
  tile.column = square.column;
  tile.row = square.row;
  tile.side = square.side;
  for (tile.first = 0; tile.first < count; tile.first += cells_max) {
    tile.count = std::min(cells_max, count - tile.first);
    tiles.push_back(tile);
  }
}

/// A node over cells [first, end) and those below it, which hold a quarter of them each, or what is left.
void add_node(TileLayout& layout, std::uint32_t first, std::uint32_t end) {
  const std::size_t at = layout.nodes.size();
  TileNode node{1e30f, 1e30f, -1e30f, -1e30f, first, end, 0};
  for (std::uint32_t k = first; k < end; ++k)
    for (std::uint32_t c = 0; c < layout.cells[k].count; ++c) {
      node.u0 = std::min(node.u0, layout.cells[k].u[c]);
      node.u1 = std::max(node.u1, layout.cells[k].u[c]);
      node.v0 = std::min(node.v0, layout.cells[k].v[c]);
      node.v1 = std::max(node.v1, layout.cells[k].v[c]);
    }
  layout.nodes.push_back(node);
  std::uint32_t part = 1;
  while (4 * part < end - first) part *= 4;
  for (std::uint32_t k = first; end - first > 1 && k < end; k += part)
    add_node(layout, k, std::min(k + part, end));
  layout.nodes[at].beyond = static_cast<std::uint32_t>(layout.nodes.size());
}

}  // namespace

void add_tiles(const Patches& patches, PatchId first, PatchId end, std::uint32_t cells_max,
               std::vector<Tile>& tiles) {
  for (PatchId patch = first; patch < end;) {
    const std::uint32_t facet_index = patches.facet_of[patch];
    const Facet& facet = patches.facets[facet_index];
    const bool back = patches.is_back(patch);
    const PatchId side_first = facet.first_patch + (back ? facet.cell_count() : 0);
    const PatchId side_end = side_first + facet.cell_count();
    const CellRange asked{patch - side_first, std::min(end, side_end) - side_first};
    const Grid grid{facet};
    for (std::uint32_t row = 0; row < grid.rows(); row += kSide) {
      if (grid.first_in_row(row) >= asked.end || grid.first_in_row(row + kSide) <= asked.first) continue;
      for (std::uint32_t column = 0; column < grid.columns(); column += kSide)
        add_squares(grid, {column, row, kSide}, cells_max, asked, {facet_index, back}, tiles);
    }
    patch = side_end;
  }
}

void lay_out(const Patches& patches, const Tile& tile, TileLayout& layout) {
  const Facet& facet = patches.facets[tile.facet];
  const PatchId first_patch = facet.first_patch + (tile.back ? facet.cell_count() : 0);
  layout.patches.clear();
  layout.cells.clear();
  layout.nodes.clear();
  std::uint32_t passed = 0;
  Grid{facet}.each_position({tile.column, tile.row, tile.side}, [&](std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t cell = first; cell < end; ++cell, ++passed)
      if (passed >= tile.first && passed < tile.first + tile.count) {
        layout.patches.push_back(first_patch + cell);
        layout.cells.push_back(cell_corners(facet, cell));
      }
  });
  add_node(layout, 0, static_cast<std::uint32_t>(layout.patches.size()));
}

}  // namespace engine
