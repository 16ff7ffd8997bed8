#include "engine/patches/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "engine/patches/ear_clipping.h"

namespace engine {
namespace {

/// Parts an edge is cut into. A hair of slack, so that 30 m / 0.1875 m is 160 and not 161.
std::uint32_t parts_of(float edge_m, double patch_edge_m) {
  const double parts = std::ceil(static_cast<double>(edge_m) / patch_edge_m - 1e-6);
  return static_cast<std::uint32_t>(std::clamp(parts, 1.0, 1e6));
}

/// Four corners whose diagonals bisect each other, within rounding.
bool is_parallelogram(std::span<const Vec3> corners) {
  if (corners.size() != 4) return false;
  const Vec3 gap = corners[0] + corners[2] - corners[1] - corners[3];
  return length(gap) <= 1e-5f * (length(corners[2] - corners[0]) + length(corners[3] - corners[1]));
}

/// How long a facet is along u and v  [m]; a triangle, all of whose edges are cut alike, as its longest edge.
std::pair<float, float> edges_of(const Facet& facet) {
  if (facet.is_triangle) {
    const float longest =
        std::max({length(facet.edge_u), length(facet.edge_v), length(facet.edge_v - facet.edge_u)});
    return {longest, longest};
  }
  return {length(facet.edge_u), length(facet.edge_v)};
}

/// What the edges of `facet` are cut by.
double cut_edge_m(const Facet& facet, const MeshOptions& options) {
  if (options.layout == api::PatchLayout::uniform) return options.patch_edge_m;
  const auto [u, v] = edges_of(facet);
  const double most = facet.is_triangle ? kCoarseEdge * options.patch_edge_m : 2.0 * std::min(u, v);
  return std::clamp(most, options.patch_edge_m, kCoarseEdge * options.patch_edge_m);
}

/// `corners`: 3, or the 4 of a parallelogram, in order around it.
Facet facet_at(std::span<const Vec3> corners, const MeshOptions& options) {
  const bool is_triangle = corners.size() == 3;
  const Vec3 edge_u = corners[1] - corners[0], edge_v = corners.back() - corners[0];
  Facet facet;
  std::copy(corners.begin(), corners.end(), facet.corners.begin());
  facet.origin = corners[0];
  facet.edge_u = edge_u;
  facet.edge_v = edge_v;
  facet.is_triangle = is_triangle;
  const Vec3 doubled = cross(edge_u, edge_v);
  facet.area_m2 = (is_triangle ? 0.5f : 1.0f) * length(doubled);
  if (facet.area_m2 > 0) facet.normal = normalized(doubled);
  const double cut_m = cut_edge_m(facet, options);
  const auto [u, v] = edges_of(facet);
  facet.grid_u = parts_of(u, cut_m);
  facet.grid_v = is_triangle ? facet.grid_u : parts_of(v, cut_m);
  return facet;
}

/// Slivers whose area is lost in rounding would have no normal.
bool has_area(const Facet& facet) {
  const float size = std::max(length(facet.edge_u), length(facet.edge_v));
  return std::isfinite(facet.area_m2) && facet.area_m2 > 1e-7f * size * size;
}

/// What one polygon needs after another, so that none of them allocates.
struct FacetScratch {
  std::vector<Vec3> corners;
  EarClipping ears;
};

/// Calls `use` with the facets of a polygon whose corners are scratch.corners.
template <class Use>
void for_each_facet_of(FacetScratch& scratch, const MeshOptions& options, Use use) {
  const std::span<const Vec3> corners = scratch.corners;
  if (corners.size() == 3 || is_parallelogram(corners)) return use(facet_at(corners, options));
  for (const auto& [a, b, c] : scratch.ears.clip(corners))
    use(facet_at(std::array{corners[a], corners[b], corners[c]}, options));
}

/// Calls `use(facet)` for every facet that has an area. The number of those without.
template <class Use>
std::uint64_t for_each_facet(const Scene& scene, const MeshOptions& options, Use use) {
  std::uint64_t dropped = 0;
  FacetScratch scratch;
  for (std::uint32_t p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    scratch.corners.clear();
    for (std::uint32_t c = 0; c < polygon.corner_count; ++c)
      scratch.corners.push_back(scene.vertices[scene.corners[polygon.first_corner + c]]);
    for_each_facet_of(scratch, options, [&](Facet&& facet) {
      facet.object = polygon.object;
      facet.material = polygon.material;
      facet.polygon = p;
      facet.both_sides = scene.materials[polygon.material].both_sides;
      if (has_area(facet))
        use(std::move(facet));
      else
        ++dropped;
    });
  }
  return dropped;
}

/// No fewer than for_each_facet visits: their list is then allocated once, and not copied while it grows.
std::size_t facets_at_most(const Scene& scene) {
  std::size_t count = 0;
  for (const Polygon& polygon : scene.polygons) count += polygon.corner_count - 2;
  return count;
}

api::Error without_area() {
  return {api::Fault::invalid_request, "no polygon of the scene has an area"};
}

/// Sums of 1e7 polygons of 1e12 cells would overflow.
constexpr std::uint64_t kCountedMax = 1'000'000'000'000'000;

/// Of a facet without trees.
std::uint64_t patch_count_of_grid(const Facet& facet) {
  return std::uint64_t{facet.grid_u} * facet.grid_v * (facet.both_sides ? 2 : 1);
}

/// Sets facet_of and area_m2 of facets without trees, `total` patches together.
void fill_grid_patches(Patches& patches, std::uint64_t total) {
  patches.facet_of.reserve(total);
  patches.area_m2.reserve(total);
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    const float area_m2 = facet.area_m2 / static_cast<float>(facet.grid_cells());
    patches.facet_of.insert(patches.facet_of.end(), facet.patch_count(), f);
    patches.area_m2.insert(patches.area_m2.end(), facet.patch_count(), area_m2);
  }
}

/// Counts first_leaf of every tree; an empty list where none of them is quartered.
void number_leaves(Facet& facet) {
  std::uint32_t leaves = 0;
  for (CellTree& tree : facet.trees) {
    tree.first_leaf = leaves;
    leaves += tree.leaf_count();
  }
  if (leaves == facet.trees.size()) facet.trees.clear();
}

/// The areas of the cells of a facet, in order.
void append_areas(const Facet& facet, std::vector<float>& area_m2) {
  const float of_grid_cell = facet.area_m2 / static_cast<float>(facet.grid_cells());
  if (facet.trees.empty()) area_m2.insert(area_m2.end(), facet.grid_cells(), of_grid_cell);
  for (const CellTree& tree : facet.trees)
    for (std::uint32_t k = 0; k < tree.leaf_count(); ++k)
      area_m2.push_back(of_grid_cell * static_cast<float>(leaf_of(tree, k).slots) / kCellTreeSlots);
}

}  // namespace

api::Result<Patches> mesh_into_patches(const Scene& scene, const MeshOptions& options) {
  Patches patches;
  patches.facets.reserve(facets_at_most(scene));
  std::uint64_t total = 0;
  patches.dropped_facets = for_each_facet(scene, options, [&](Facet&& facet) {
    facet.first_patch = static_cast<PatchId>(total);
    total = std::min(kCountedMax, total + patch_count_of_grid(facet));
    if (total <= kPatchesMax) patches.facets.push_back(std::move(facet));
  });
  if (total > kPatchesMax)
    return api::Error{api::Fault::out_of_resources, "the scene cuts into more than " +
                                                        std::to_string(kPatchesMax) +
                                                        " patches; choose a larger patch_edge_m"};
  if (total == 0) return without_area();
  fill_grid_patches(patches, total);
  return patches;
}

api::Result<Patches> mesh_into_patches(const Scene& scene, double patch_edge_m) {
  return mesh_into_patches(scene, MeshOptions{patch_edge_m, api::PatchLayout::uniform});
}

api::Result<PatchCount> count_patches(const Scene& scene, const MeshOptions& options) {
  PatchCount count;
  const bool adaptive = options.layout == api::PatchLayout::adaptive;
  count.dropped_facets = for_each_facet(scene, options, [&](const Facet& facet) {
    const std::uint64_t cells = patch_count_of_grid(facet);
    const std::uint32_t levels = adaptive ? levels_of(facet, options.patch_edge_m) : 0;
    count.patches = std::min(kCountedMax, count.patches + cells);
    count.finest = std::min(kCountedMax, count.finest + (cells << 2 * levels));
  });
  if (count.patches == 0) return without_area();
  return count;
}

api::Result<PatchCount> count_patches(const Scene& scene, double patch_edge_m) {
  return count_patches(scene, MeshOptions{patch_edge_m, api::PatchLayout::uniform});
}

std::uint32_t levels_of(const Facet& facet, double patch_edge_m) {
  const auto [u, v] = edges_of(facet);
  const double edge_m =
      std::max(static_cast<double>(u) / facet.grid_u, static_cast<double>(v) / facet.grid_v);
  std::uint32_t levels = 0;
  while (levels < kCellTreeLevels && edge_m > kFineEdge * patch_edge_m * (1 << levels) * (1 + 1e-6)) ++levels;
  return levels;
}

void number_patches(Patches& patches) {
  patches.facet_of.clear();
  patches.area_m2.clear();
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    Facet& facet = patches.facets[f];
    number_leaves(facet);
    facet.first_patch = patches.count();
    patches.facet_of.resize(patches.count() + facet.patch_count(), f);
    for (int side = 0; side < (facet.both_sides ? 2 : 1); ++side) append_areas(facet, patches.area_m2);
  }
}

}  // namespace engine
