// Neighbours whose grids differ along their common edge. Internal to engine/image.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/rgb.h"
#include "engine/patches/patches.h"

namespace engine {

struct ShadingMesh;

/// A node inside an edge that two sides share but cut into different parts, so that the neighbour has no node
/// there. Each side alone knows the radiosity on its half of the node's surroundings only, which would show
/// as a step: the node takes a mean of its own value and of the neighbour's on that point,
///     own_share own + (1 - own_share) ((1 - t) before + t after),
/// with own_share a half; but 0 where the neighbour is quartered less often, as for a HangingNode.
struct SeamNode {
  std::uint32_t node = 0;
  std::uint32_t before = 0, after = 0;  ///< the neighbour's nodes on either side of it
  float t = 0;
  float own_share = 0.5f;
};

/// A corner of quarters inside an edge of a larger cell of the same facet. The larger cell is blended between
/// the ends of its edge, so the node takes the value there: no crack, no step.
struct HangingNode {
  std::uint32_t node = 0;
  std::uint32_t before = 0, after = 0;  ///< the ends of the edge
  float t = 0;
  std::uint32_t edge = 0;  ///< how long it is, in lattice parts
};

/// All of them, both ways. `mesh` needs first_place and node_of. Edges that match in part only are not found.
std::vector<SeamNode> find_seams(const ShadingMesh& mesh, const Patches& patches);

/// Replaces the values of the seam nodes, all from the values given.
void close_seams(const std::vector<SeamNode>& seams, std::vector<Rgb>& node_values);

/// Sets the values of the hanging nodes, one after the other: an end of an edge may itself hang on a longer
/// one, and those come first.
void hang(const std::vector<HangingNode>& hanging, std::vector<Rgb>& node_values);

}  // namespace engine
