// Surfaces cut into patches: each facet (parallelogram or triangle) carries a regular (u,v) grid of cells,
// and each cell is a patch or, in the adaptive layout, a tree of quarters.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "api/ids.h"
#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/base/vec3.h"
#include "engine/patches/cell_tree.h"
#include "engine/scene/scene.h"

namespace engine {

using api::PatchId;
inline constexpr PatchId kNoPatch = 0xffffffffu;

/// A planar piece of a polygon that rays are traced against; its points are origin + u edge_u + v edge_v.
/// Parallelogram: u, v in [0,1], cut into grid_u x grid_v equal grid cells.
/// Triangle: u, v >= 0, u + v <= 1, cut into grid_u^2 equal triangles (grid_v == grid_u).
/// A cell is what is one patch on each side: a grid cell, or with `trees` one of its leaves.
/// The front is the side from which origin, edge_u, edge_v turn counter-clockwise.
struct Facet {
  Vec3 origin, edge_u, edge_v;  ///< object space  [m]
  /// In order around the facet, 3 of them for a triangle, corners[0] == origin; the polygon's vertices bit
  /// for bit, so that neighbours share them: origin + edge_u is rounded twice and is a neighbour's corner no
  /// more.
  std::array<Vec3, 4> corners;  ///< object space  [m]
  Vec3 normal;                  ///< unit, of the front, object space
  float area_m2 = 0;            ///< object space
  bool is_triangle = false;
  bool both_sides = false;  ///< false: the back absorbs everything and has no patches
  std::uint32_t grid_u = 1, grid_v = 1;
  std::vector<CellTree> trees;  ///< [grid cell]; empty: none is quartered
  PatchId first_patch = 0;      ///< fronts first, then (both_sides) backs, each in cell order
  std::uint32_t object = 0, material = 0, polygon = 0;  ///< into the Scene

  std::uint32_t grid_cells() const { return grid_u * grid_v; }
  std::uint32_t cell_count() const {
    return trees.empty() ? grid_cells() : trees.back().first_leaf + trees.back().leaf_count();
  }
  std::uint32_t patch_count() const { return both_sides ? 2 * cell_count() : cell_count(); }
};

/// floor(x n), clamped to the grid: hits on the far edge belong to the last cell.
inline std::uint32_t index_in_grid(float x, std::uint32_t n) {
  const float scaled = x * static_cast<float>(n);
  return scaled <= 0 ? 0 : std::min(static_cast<std::uint32_t>(scaled), n - 1);
}

/// The cell of a facet that holds (u, v). Grid cells of a parallelogram: row-major, u fastest; of a triangle:
/// row by row from v = 0, in each row alternately upright and inverted; row j starts at j (2 n - j). Leaves:
/// those of a grid cell together, in the order of their slots. Takes no longer for the smallest leaves.
std::uint32_t cell_at(const Facet& facet, float u, float v);

/// The corners of a cell in (u, v), counter-clockwise seen from the front: 4, or 3 for a triangle's.
struct CellCorners {
  std::uint32_t count = 0;
  float u[4], v[4];
};
CellCorners cell_corners(const Facet& facet, std::uint32_t cell);

/// The same on the facet's lattice, of a facet with trees: of a cell, or of any quarter of a grid cell.
LeafCorners leaf_corners(const Facet& facet, std::uint32_t cell);
LeafCorners leaf_corners(const Facet& facet, std::uint32_t grid_cell, Leaf leaf);

struct Patches {
  std::vector<Facet> facets;
  std::vector<std::uint32_t> facet_of;   ///< [patch]
  std::vector<float> area_m2;            ///< [patch]; one side, object space
  std::vector<Rgb> texture_reflectance;  ///< [patch]; empty: no facet shows a texture. Set after meshing
  std::uint64_t dropped_facets = 0;      ///< too thin to have an area; nothing sees them
  std::uint32_t count() const { return static_cast<std::uint32_t>(facet_of.size()); }

  bool is_back(PatchId patch) const {
    const Facet& facet = facets[facet_of[patch]];
    return patch - facet.first_patch >= facet.cell_count();
  }
  std::uint32_t cell_of(PatchId patch) const {
    const Facet& facet = facets[facet_of[patch]];
    return (patch - facet.first_patch) % facet.cell_count();
  }
  /// The patch on the front (or back) of a facet at (u, v); kNoPatch on the back of a one-sided facet.
  PatchId patch_at(std::uint32_t facet, float u, float v, bool front) const;
};

inline constexpr std::uint32_t kPatchesMax = 20'000'000;

/// What mesh_into_patches would make.
struct PatchCount {
  std::uint64_t patches = 0;  ///< may be more than kPatchesMax; held at 1e15
  std::uint64_t finest = 0;   ///< with every cell quartered as often as may be; held at 1e15
  std::uint64_t dropped_facets = 0;
};

/// How edges are cut. `uniform`: into ceil(edge / patch_edge_m) parts, of a triangle all three into as many
/// as the longest needs. `adaptive`: the same with an edge of a facet's own, 1 .. kCoarseEdge patch_edge_m
/// and twice the shorter edge of a parallelogram where that lies between (quarters keep the shape of their
/// cell, and long thin ones help nobody); every cell may then be quartered until it is no longer than
/// kFineEdge patch_edge_m.
struct MeshOptions {
  double patch_edge_m = 0.175;  ///< > 0  [m]
  api::PatchLayout layout = api::PatchLayout::uniform;
};
inline constexpr double kCoarseEdge = 2, kFineEdge = 0.25;
static_assert(kCoarseEdge / kFineEdge <= kLatticeParts);

/// Cuts every polygon into facets, and those into grid cells, none of them quartered. Lengths are those of
/// the OBJ in metres, before any scale that the animation gives an object. Parallelograms stay whole, other
/// polygons are triangulated (ear clipping). Facets without area are dropped and counted.
/// Errors: out_of_resources beyond kPatchesMax; invalid_request where no polygon has an area.
api::Result<Patches> mesh_into_patches(const Scene& scene, const MeshOptions& options);

/// The same in the layout `uniform`.
api::Result<Patches> mesh_into_patches(const Scene& scene, double patch_edge_m);

/// Counts them without making them: memory for one polygon only. Error: invalid_request as above.
api::Result<PatchCount> count_patches(const Scene& scene, const MeshOptions& options);
api::Result<PatchCount> count_patches(const Scene& scene, double patch_edge_m);

/// How often the grid cells of a facet may be quartered, 0 .. kCellTreeLevels; see MeshOptions.
std::uint32_t levels_of(const Facet& facet, double patch_edge_m);

/// Numbers the patches anew after trees of facets were set or changed: first_leaf, first_patch, facet_of and
/// area_m2 follow from them. Trees that quarter nothing are removed from facets that have no others.
/// Precondition: no more than kPatchesMax patches.
void number_patches(Patches& patches);

}  // namespace engine
