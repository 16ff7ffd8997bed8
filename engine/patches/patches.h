// Surfaces cut into patches: each facet (parallelogram or triangle) carries a regular (u,v) grid of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "api/ids.h"
#include "api/result.h"
#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace engine {

using api::PatchId;
inline constexpr PatchId kNoPatch = 0xffffffffu;

/// A planar piece of a polygon that rays are traced against; its points are origin + u edge_u + v edge_v.
/// Parallelogram: u, v in [0,1], cut into grid_u x grid_v equal cells.
/// Triangle: u, v >= 0, u + v <= 1, cut into grid_u^2 equal triangles (grid_v == grid_u).
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
  PatchId first_patch = 0;  ///< fronts first, then (both_sides) backs, each in cell order
  std::uint32_t object = 0, material = 0, polygon = 0;  ///< into the Scene

  std::uint32_t cell_count() const { return grid_u * grid_v; }
  std::uint32_t patch_count() const { return both_sides ? 2 * cell_count() : cell_count(); }
};

/// The cell of a facet that holds (u, v). Parallelogram: row-major, u fastest. Triangle: row by row from
/// v = 0, in each row alternately upright and inverted; row j starts at j (2 n - j).
std::uint32_t cell_at(const Facet& facet, float u, float v);

/// The corners of a cell in (u, v), counter-clockwise seen from the front: 4, or 3 for a triangle's.
struct CellCorners {
  std::uint32_t count = 0;
  float u[4], v[4];
};
CellCorners cell_corners(const Facet& facet, std::uint32_t cell);

struct Patches {
  std::vector<Facet> facets;
  std::vector<std::uint32_t> facet_of;  ///< [patch]
  std::vector<float> area_m2;           ///< [patch]; one side, object space
  std::vector<Rgb> texture_reflectance;  ///< [patch]; empty: no facet shows a texture. Set after meshing
  std::uint64_t dropped_facets = 0;     ///< too thin to have an area; nothing sees them
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
  std::uint64_t dropped_facets = 0;
};

/// Cuts every polygon into facets, and every facet edge into ceil(edge / patch_edge_m) parts, of a triangle
/// all three edges into as many as the longest needs. Lengths are those of the OBJ in metres, before any
/// scale that the animation gives an object. Parallelograms stay whole, other polygons are triangulated (ear
/// clipping). Facets without area are dropped and counted.
/// patch_edge_m > 0  [m]
/// Errors: out_of_resources beyond kPatchesMax; invalid_request where no polygon has an area.
api::Result<Patches> mesh_into_patches(const Scene& scene, double patch_edge_m);

/// Counts them without making them: memory for one polygon only. Error: invalid_request as above.
api::Result<PatchCount> count_patches(const Scene& scene, double patch_edge_m);

}  // namespace engine
