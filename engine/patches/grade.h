// Neighbouring cells of a facet differ by one halving at most.
#pragma once

#include "engine/patches/patches.h"

namespace engine {

/// A place on the lattice of a facet with trees: which grid cell, and which slot of its tree.
struct LatticeSlot {
  std::uint32_t grid_cell = 0, slot = 0;
};

/// The one that holds (u, v).
LatticeSlot slot_at(const Facet& facet, float u, float v);

/// Quarters the larger of every two cells with a common edge, one of which is longer than twice the other,
/// until there are none. Pictures need it: a node where small dark cells meet a large one would darken all of
/// that. Then number_patches() is due. Cells of different facets have no say in each other.
/// Precondition: `facet` has trees.
void grade(Facet& facet);

}  // namespace engine
