// Patches are constant, pictures are smooth: radiosity at the corners of the patches, and between them.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/image/corner_normals.h"
#include "engine/image/seams.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"

namespace engine {

/// The corners of all facets' cells, one set of nodes per side that has patches. A node's radiosity is the
/// weighted mean of the patches around it, see node_weight(). Nodes of neighbouring facets that lie at the
/// same point are one node when the sides belong to the same object and material and face the same way
/// (within 1 degree; on smooth surfaces by their shading normals there), so that no seam shows between
/// coplanar polygons and on curved things; sides that differ in any of these are never mixed. Where two such
/// facets cut their common edge differently, see SeamNode; where quarters meet larger cells of their facet,
/// HangingNode.
struct ShadingMesh {
  std::uint32_t node_count = 0;
  std::vector<std::uint32_t> first_place;  ///< [facet]: its front's places, then its back's, in node_of
  std::vector<std::uint32_t> node_of;      ///< [place]: the node there; see place_count()
  std::vector<std::uint32_t> first_patch;  ///< [node .. node_count]: into patches_around
  std::vector<PatchId> patches_around;
  std::vector<SeamNode> seams;
  std::vector<HangingNode> hanging;  ///< those on longer edges first: what a node hangs on is settled before
  bool has_trees = false;            ///< of some facet
};

/// Depends on the scene alone: built once for all frames and cameras. `normals`: [facet], or empty where
/// every facet is flat.
ShadingMesh build_shading_mesh(const Patches& patches, std::span<const CornerNormals> normals = {});

/// Places of nodes on one side of a facet. With trees: the corners of its cells, corner_count() for each.
/// Without: the points of its grid, see grid_place().
std::uint32_t place_count(const Facet& facet);
inline std::uint32_t corner_count(const Facet& facet) {
  return facet.is_triangle ? 3 : 4;
}

/// Parallelogram: (grid_u + 1)(grid_v + 1) points, row-major, u fastest. Triangle: row by row from v = 0, row
/// j has grid_u + 1 - j.
std::uint32_t grid_place(const Facet& facet, std::uint32_t i, std::uint32_t j);

/// What a patch counts for at its corners. Its area; but where sizes differ within facets the inverse of its
/// size, 1 / sqrt(area): the middle of a patch twice as long is twice as far off, and the nodes of a linear
/// field are then exact, whatever sizes meet there.
inline float node_weight(const ShadingMesh& mesh, const Patches& patches, PatchId patch) {
  return mesh.has_trees ? 1 / std::sqrt(patches.area_m2[patch]) : patches.area_m2[patch];
}

/// Radiosity of every node in the frames [first_frame, first_frame + values.size()); values[k] is resized to
/// node_count.  [W/m^2] False when stopped; the values then mean nothing.
bool node_radiosity(const ShadingMesh& mesh, const Patches& patches, const PatchSeries& radiosity_w_m2,
                    std::uint32_t first_frame, const std::function<bool()>& stop_requested,
                    std::span<std::vector<Rgb>> values_w_m2);

struct NodeWeight {
  std::uint32_t node = 0;
  float weight = 0;
};

/// Radiosity at a point = sum of weight x node radiosity over the first `count`; the weights sum to 1.
/// Parallelogram cells: bilinear between 4 nodes. Triangle cells: linear between 3. count = 0: the back of a
/// one-sided facet, black.
struct NodeBlend {
  std::uint32_t count = 0;
  NodeWeight nodes[4];
};
NodeBlend blend_at(const ShadingMesh& mesh, const Patches& patches, std::uint32_t facet, float u, float v,
                   bool front);

}  // namespace engine
