// Neighbouring patches, which are lit together.
#pragma once

#include <vector>

#include "engine/patches/patches.h"

namespace engine {

/// Cells of one side of a facet, in a square of its grid. It follows from the facet alone, whichever patches
/// are lit.
struct Tile {
  std::uint32_t facet = 0;
  bool back = false;
  std::uint32_t column = 0, row = 0, side = 1;  ///< of the square, in grid cells (triangles: pairs of them)
  std::uint32_t first = 0, count = 0;           ///< of the cells in it, in the order of TileLayout
};

inline constexpr std::uint32_t kTileCellsMax = 64;

/// Adds the tiles that hold patches of [first, end), of at most `cells_max` cells each.  1 .. kTileCellsMax
void add_tiles(const Patches& patches, PatchId first, PatchId end, std::uint32_t cells_max,
               std::vector<Tile>& tiles);

/// Some cells of a tile, as a rectangle in (u, v) that holds them.
struct TileNode {
  float u0 = 0, v0 = 0, u1 = 0, v1 = 0;
  std::uint32_t first = 0, end = 0;  ///< into the cells
  std::uint32_t beyond = 0;          ///< the node after all below this one
};

/// The cells of a tile such that neighbours in the list are neighbours on the facet: quarter by quarter.
struct TileLayout {
  std::vector<PatchId> patches;
  std::vector<CellCorners> cells;
  /// A tree of runs: each node before its children, those one after the other; leaves hold one cell.
  std::vector<TileNode> nodes;
};

/// Replaces `layout`.
void lay_out(const Patches& patches, const Tile& tile, TileLayout& layout);

}  // namespace engine
