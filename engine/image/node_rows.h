// The values of nodes as a matrix: what pictures make of patches, for those who make their own.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/image/shading_mesh.h"
#include "engine/image/uncovered.h"
#include "engine/patches/patches.h"

namespace engine {

struct PatchWeight {
  PatchId patch = 0;
  float weight = 0;
};

/// Radiosity of a node = sum of weight x radiosity of patch, in every frame: node_radiosity() and then
/// show_uncovered() in one, which are linear.
/// Facets that show a texture are treated as if they did not: their pictures join irradiance between nodes
/// and multiply it with the texture (see TexturedView), rows join the radiosity itself.
class NodeRows {
 public:
  /// All of it outlives this. Holds the rows that are not plain means: those of seams, of hanging nodes and
  /// of nodes beside what is covered.
  NodeRows(const ShadingMesh& mesh, const Patches& patches, const Uncovered& uncovered);

  std::uint32_t node_count() const { return mesh_.node_count; }
  std::uint32_t size_of(std::uint32_t node) const;
  /// Appends the row of `node`.
  void append(std::uint32_t node, std::vector<PatchWeight>& row) const;

 private:
  using Row = std::vector<PatchWeight>;

  void append_mean(std::uint32_t node, Row& row) const;
  void add(std::uint32_t node, float share, Row& sum) const;
  void close_seams();
  void hang();
  void show_uncovered(const Uncovered& uncovered);

  const ShadingMesh& mesh_;
  const Patches& patches_;
  std::unordered_map<std::uint32_t, Row> special_;  ///< by node
};

/// The nodes at the corners of a patch: 4, or 3 for a triangle; counter-clockwise seen from the patch's own
/// side. Of a front they begin with those at (0, 0), (1, 0), (1, 1), (0, 1) of its cell (of a triangle: its
/// three corners); of a back it is the same turn the other way about, from the last to the first.
struct PatchNodes {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 4> node{};
};
PatchNodes nodes_of_patch(const ShadingMesh& mesh, const Patches& patches, PatchId patch);

/// Object space  [m]
Vec3 position_of_node(const ShadingMesh& mesh, const Patches& patches, std::uint32_t node);

}  // namespace engine
