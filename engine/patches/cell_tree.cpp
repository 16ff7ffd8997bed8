#include "engine/patches/cell_tree.h"

#include <array>

namespace engine {
namespace {

/// Every second bit of `code`, from the lowest on.
std::uint32_t even_bits(std::uint32_t code) {
  return (code & 1) | (code >> 1 & 2) | (code >> 2 & 4);
}

std::uint32_t spread_bits(std::uint32_t x) {
  return (x & 1) | (x & 2) << 1 | (x & 4) << 2;
}

LatticePoint middle(LatticePoint a, LatticePoint b) {
  return {(a.i + b.i) / 2, (a.j + b.j) / 2};
}

}  // namespace

Leaf leaf_of(const CellTree& tree, std::uint32_t index) {
  std::uint64_t starts = tree.leaf_starts;
  for (std::uint32_t k = 0; k < index; ++k) starts &= starts - 1;
  const auto first = static_cast<std::uint32_t>(std::countr_zero(starts));
  starts &= starts - 1;
  const auto end = static_cast<std::uint32_t>(std::countr_zero(starts));  // 64 where there is no further one
  return {first, end - first};
}

std::uint32_t square_slot(std::uint32_t i, std::uint32_t j) {
  return spread_bits(i) | spread_bits(j) << 1;
}

std::uint32_t triangle_slot(std::uint32_t i, std::uint32_t j, bool inverted) {
  std::uint32_t slot = 0;
  for (std::uint32_t half = kLatticeParts / 2; half > 0; half /= 2) {
    slot *= 4;
    if (i >= half) {
      slot += 1;
      i -= half;
    } else if (j >= half) {
      slot += 2;
      j -= half;
    } else if (i + j + (inverted ? 1 : 0) >= half) {
      slot += 3;
      i = half - 1 - i;
      j = half - 1 - j;
      inverted = !inverted;
    }
  }
  return slot;
}

LeafCorners square_leaf_corners(LatticePoint low, Leaf leaf) {
  const std::uint32_t i = low.i + even_bits(leaf.first), j = low.j + even_bits(leaf.first >> 1);
  const std::uint32_t n = leaf.parts();
  return {4, {{i, j}, {i + n, j}, {i + n, j + n}, {i, j + n}}};
}

LeafCorners triangle_leaf_corners(LatticePoint low, bool inverted, Leaf leaf) {
  constexpr std::uint32_t n = kLatticeParts;
  const LatticePoint high{low.i + n, low.j + n}, right{low.i + n, low.j}, above{low.i, low.j + n};
  auto corners = inverted ? std::array{high, above, right} : std::array{low, right, above};
  for (std::uint32_t slots = kCellTreeSlots; slots > leaf.slots; slots /= 4) {
    const LatticePoint m01 = middle(corners[0], corners[1]), m12 = middle(corners[1], corners[2]),
                       m02 = middle(corners[0], corners[2]);
    switch (leaf.first % slots / (slots / 4)) {
      case 0:
        corners = {corners[0], m01, m02};
        break;
      case 1:
        corners = {m01, corners[1], m12};
        break;
      case 2:
        corners = {m02, m12, corners[2]};
        break;
      default:
        corners = {m12, m02, m01};
        break;
    }
  }
  return {3, {corners[0], corners[1], corners[2], {}}};
}

}  // namespace engine
