#include "engine/image/lattice_nodes.h"

#include <algorithm>

namespace engine {
namespace {

/// The point `k` of `parts` on the way from a to b.
LatticePoint point_between(LatticePoint a, LatticePoint b, std::uint32_t k, std::uint32_t parts) {
  const auto on_way = [&](std::uint64_t from, std::uint64_t to) {
    return static_cast<std::uint32_t>((from * (parts - k) + to * k) / parts);
  };
  return {on_way(a.i, b.i), on_way(a.j, b.j)};
}

}  // namespace

void append_hanging(const LatticeNodes& nodes, std::vector<HangingNode>& hanging) {
  for (std::uint32_t cell = 0; cell < nodes.facet().cell_count(); ++cell) {
    const LeafCorners leaf = leaf_corners(nodes.facet(), cell);
    const LatticePoint first = leaf.at[0], second = leaf.at[1];
    const std::uint32_t parts = std::max(first.i, second.i) - std::min(first.i, second.i);
    for (std::uint32_t c = 0; c < leaf.count; ++c)
      for (std::uint32_t k = 1; k < parts; ++k) {
        const LatticePoint a = leaf.at[c], b = leaf.at[(c + 1) % leaf.count];
        const std::uint32_t node = nodes.find(point_between(a, b, k, parts));
        if (node != LatticeNodes::kNone)
          hanging.push_back(
              {node, nodes.find(a), nodes.find(b), static_cast<float>(k) / static_cast<float>(parts), parts});
      }
  }
}

}  // namespace engine
