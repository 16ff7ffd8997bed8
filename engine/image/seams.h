// Neighbours whose grids differ along their common edge. Internal to engine/image.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/rgb.h"
#include "engine/patches/patches.h"

namespace engine {

struct ShadingMesh;

/// A node inside an edge that two sides share but cut into different numbers of parts, so that the neighbour
/// has no node there. Each side alone knows the radiosity on its half of the node's surroundings only, which
/// would show as a step: the node takes the mean of its own value and of the neighbour's on that point,
///     (own + (1 - t) before + t after) / 2.
struct SeamNode {
  std::uint32_t node = 0;
  std::uint32_t before = 0, after = 0;  ///< the neighbour's nodes on either side of it
  float t = 0;
};

/// All of them, both ways. `mesh` needs first_place and node_of. Edges that match in part only are not found.
std::vector<SeamNode> find_seams(const ShadingMesh& mesh, const Patches& patches);

/// Replaces the values of the seam nodes, all from the values given.
void close_seams(const std::vector<SeamNode>& seams, std::vector<Rgb>& node_values);

}  // namespace engine
