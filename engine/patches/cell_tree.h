// A grid cell of a facet cut into quarters, and those again: which leaf holds a point, and where a leaf is.
#pragma once

#include <bit>
#include <cstdint>

namespace engine {

/// How often a grid cell can be quartered: the smallest leaves are an eighth of its edges.
inline constexpr std::uint32_t kCellTreeLevels = 3;
inline constexpr std::uint32_t kLatticeParts = 1u << kCellTreeLevels;  ///< parts of a grid cell's edge
inline constexpr std::uint32_t kCellTreeSlots = kLatticeParts * kLatticeParts;

/// One grid cell. Its smallest quarters are numbered 0 .. 63 so that those of any quarter of any level are
/// consecutive (parallelograms: Morton order, u lowest; triangles: the corners' quarters in the order of the
/// corners, then the middle one, upside down). A leaf is a run of them, and a bit says where one begins:
/// finding the leaf of a point is a mask and a population count, whatever the depth.
struct CellTree {
  std::uint64_t leaf_starts = 1;  ///< bit s: a leaf begins at slot s; bit 0 is always set
  std::uint32_t first_leaf = 0;   ///< leaves of the grid cells before it on its facet

  std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(std::popcount(leaf_starts)); }
  /// The leaf that holds `slot`, counted on the facet.
  std::uint32_t leaf_at(std::uint32_t slot) const {
    return first_leaf - 1 + static_cast<std::uint32_t>(std::popcount(leaf_starts << (63 - slot)));
  }
};

/// A leaf: `slots` (1, 4, 16 or 64) slots from `first` on.
struct Leaf {
  std::uint32_t first = 0, slots = kCellTreeSlots;
  std::uint32_t parts() const { return slots == 64 ? 8 : slots == 16 ? 4 : slots == 4 ? 2 : 1; }
};

/// The leaf number `index` of `tree`, 0 .. leaf_count() - 1.
Leaf leaf_of(const CellTree& tree, std::uint32_t index);

/// The bits that quarter `leaf`, which has more than one slot.
inline std::uint64_t quartered(Leaf leaf) {
  const std::uint32_t quarter = leaf.slots / 4;
  return (std::uint64_t{1} << quarter | std::uint64_t{1} << 2 * quarter | std::uint64_t{1} << 3 * quarter)
         << leaf.first;
}

/// A corner on the lattice of a facet: its grid with every edge cut into kLatticeParts more.
struct LatticePoint {
  std::uint32_t i = 0, j = 0;
  friend bool operator==(LatticePoint, LatticePoint) = default;
};

/// The corners of a leaf, counter-clockwise seen from the front: 4, or 3 for a triangle's.
struct LeafCorners {
  std::uint32_t count = 0;
  LatticePoint at[4];
};

/// Slot of the lattice cell (i, j), 0 .. 7 each, of a parallelogram's grid cell.
std::uint32_t square_slot(std::uint32_t i, std::uint32_t j);
/// Slot of the lattice triangle (i, j), upright or inverted, of an upright grid cell of a triangle; in an
/// inverted one, turn both by 180 degrees first: (7 - i, 7 - j), the other way up.
std::uint32_t triangle_slot(std::uint32_t i, std::uint32_t j, bool inverted);

/// `low`: the grid cell's corner of least i and j.
LeafCorners square_leaf_corners(LatticePoint low, Leaf leaf);
/// `low`: of the square that the grid cell and the one of the other way up are the halves of.
LeafCorners triangle_leaf_corners(LatticePoint low, bool inverted, Leaf leaf);

}  // namespace engine
