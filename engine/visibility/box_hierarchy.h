// A tree of boxes over boxes. Internal to engine/visibility.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/visibility/box.h"

namespace engine {

/// A leaf holds members [first, first + count), an inner node (count 0) has the children first and first + 1.
struct BoxNode {
  Vec3 lower;
  std::uint32_t first = 0;
  Vec3 upper;
  std::uint32_t count = 0;
};

struct BoxHierarchy {
  std::vector<BoxNode> nodes;        ///< nodes[0] is the root; children come after their parent
  std::vector<std::uint32_t> order;  ///< [place in a leaf] -> number of the box
};

inline constexpr std::uint32_t kHierarchyDepth = 48;  ///< of a leaf at most, the root's is 0

/// Leaves of at most `leaf_max` boxes; no nodes where there are none. The cheapest of 16 splits on each axis
/// by the surface area heuristic, in the middle of the list where that is too deep.
/// Source: Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007.
BoxHierarchy build_hierarchy(std::span<const Box> boxes, std::uint32_t leaf_max);

/// Sets the boxes of `nodes` from those of the members, boxes[place in a leaf]; nodes and places are counted
/// from those of the root nodes[0], which `node_base` and `place_base` say.
void refit(std::span<BoxNode> nodes, std::uint32_t node_base, std::span<const Box> boxes,
           std::uint32_t place_base);

}  // namespace engine
