// Facets whose cells are quartered at random.
#pragma once

#include <random>

#include "engine/patches/patches.h"
#include "tests/unit/image/rooms.h"

namespace tests {

/// A right triangle or rectangle whose edges are cut into `grid_u` and `grid_v` cells of 1 m (a triangle's
/// into grid_u).
inline engine::Patches one_facet(bool is_triangle, std::uint32_t grid_u, std::uint32_t grid_v) {
  engine::Scene scene = scene_with(1, 1);
  const auto u = static_cast<float>(grid_u), v = static_cast<float>(grid_v);
  if (is_triangle)
    add_polygon(scene, {{0, 0, 0}, {u, 0, 0}, {u / 2, u * 0.8660254f, 0}});
  else
    add_polygon(scene, {{0, 0, 0}, {u, 0, 0}, {u, v, 0}, {0, v, 0}});
  return *engine::mesh_into_patches(scene, 1.0);
}

/// Quarters each grid cell of every facet with probability `share`, and each quarter again, `levels` times.
inline void quarter_at_random(engine::Patches& patches, std::uint32_t levels, double share,
                              std::mt19937& random) {
  std::bernoulli_distribution chosen(share);
  for (engine::Facet& facet : patches.facets) {
    facet.trees.resize(facet.grid_cells());
    for (engine::CellTree& tree : facet.trees)
      for (std::uint32_t level = 0; level < levels; ++level) {
        const engine::CellTree before = tree;
        for (std::uint32_t k = 0; k < before.leaf_count(); ++k) {
          const engine::Leaf leaf = leaf_of(before, k);
          if (leaf.slots == engine::kCellTreeSlots >> 2 * level && chosen(random))
            tree.leaf_starts |= quartered(leaf);
        }
      }
  }
  number_patches(patches);
}

}  // namespace tests
