#include "engine/patches/grade.h"

#include <cmath>

namespace engine {
namespace {

/// The leaf that holds `slot`.
Leaf leaf_holding(const CellTree& tree, std::uint32_t slot) {
  return leaf_of(tree, tree.leaf_at(slot) - tree.first_leaf);
}

/// Calls visit(u, v) a little beyond the middle of each edge of a leaf, where that is on the facet.
template <class Visit>
void for_each_neighbour(const Facet& facet, const LeafCorners& leaf, Visit visit) {
  const auto n = static_cast<float>(facet.grid_u * kLatticeParts);
  const auto m = static_cast<float>(facet.grid_v * kLatticeParts);
  float i[4], j[4], middle_i = 0, middle_j = 0;
  for (std::uint32_t c = 0; c < leaf.count; ++c) {
    i[c] = static_cast<float>(leaf.at[c].i);
    j[c] = static_cast<float>(leaf.at[c].j);
    middle_i += i[c] / static_cast<float>(leaf.count);
    middle_j += j[c] / static_cast<float>(leaf.count);
  }
  const float size = std::abs(i[1] - i[0]);
  for (std::uint32_t c = 0; c < leaf.count; ++c) {
    const std::uint32_t next = (c + 1) % leaf.count;
    const float edge_i = 0.5f * (i[c] + i[next]), edge_j = 0.5f * (j[c] + j[next]);
    const float out_i = edge_i + (edge_i - middle_i) * (0.5f / size);
    const float out_j = edge_j + (edge_j - middle_j) * (0.5f / size);
    if (out_i < 0 || out_j < 0) continue;
    if (facet.is_triangle ? out_i + out_j > n : out_i > n || out_j > m) continue;
    visit(out_i / n, out_j / m);
  }
}

/// Quarters what is too large beside the leaves of one grid cell. Was there any?
bool grade_beside(Facet& facet, std::uint32_t grid_cell) {
  bool changed = false;
  const CellTree tree = facet.trees[grid_cell];
  for (std::uint32_t k = 0; k < tree.leaf_count(); ++k) {
    const Leaf leaf = leaf_of(tree, k);
    for_each_neighbour(facet, leaf_corners(facet, grid_cell, leaf), [&](float u, float v) {
      const LatticeSlot at = slot_at(facet, u, v);
      CellTree& beside = facet.trees[at.grid_cell];
      const Leaf other = leaf_holding(beside, at.slot);
      if (other.parts() <= 2 * leaf.parts()) return;
      beside.leaf_starts |= quartered(other);
      changed = true;
    });
  }
  return changed;
}

}  // namespace

void grade(Facet& facet) {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t cell = 0; cell < facet.grid_cells(); ++cell)
      changed = grade_beside(facet, cell) || changed;
  }
}

}  // namespace engine
