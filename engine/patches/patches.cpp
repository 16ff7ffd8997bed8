#include "engine/patches/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

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

/// `corners`: 3, or the 4 of a parallelogram, in order around it.
Facet facet_at(std::span<const Vec3> corners, double patch_edge_m) {
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
  if (is_triangle) {
    const float longest = std::max({length(edge_u), length(edge_v), length(edge_v - edge_u)});
    facet.grid_u = facet.grid_v = parts_of(longest, patch_edge_m);
  } else {
    facet.grid_u = parts_of(length(edge_u), patch_edge_m);
    facet.grid_v = parts_of(length(edge_v), patch_edge_m);
  }
  return facet;
}

/// Slivers whose area is lost in rounding would have no normal.
bool has_area(const Facet& facet) {
  const float size = std::max(length(facet.edge_u), length(facet.edge_v));
  return std::isfinite(facet.area_m2) && facet.area_m2 > 1e-7f * size * size;
}

/// Appends the patches of `facet`. False beyond kPatchesMax.
bool append(Patches& patches, Facet facet) {
  const std::uint64_t cells = std::uint64_t{facet.grid_u} * facet.grid_v;
  const std::uint64_t total = patches.count() + cells * (facet.both_sides ? 2 : 1);
  if (total > kPatchesMax) return false;
  facet.first_patch = patches.count();
  const auto index = static_cast<std::uint32_t>(patches.facets.size());
  patches.facet_of.resize(total, index);
  patches.area_m2.resize(total, facet.area_m2 / static_cast<float>(cells));
  patches.facets.push_back(facet);
  return true;
}

std::vector<Facet> facets_of(std::span<const Vec3> corners, double patch_edge_m) {
  if (is_parallelogram(corners)) return {facet_at(corners, patch_edge_m)};
  std::vector<Facet> facets;
  for (const auto& [a, b, c] : clip_ears(corners))
    facets.push_back(facet_at(std::array{corners[a], corners[b], corners[c]}, patch_edge_m));
  return facets;
}

/// Calls `use(facet)` for every facet that has an area until it answers false. The number of those without.
template <class Use>
std::uint64_t for_each_facet(const Scene& scene, double patch_edge_m, Use use) {
  std::uint64_t dropped = 0;
  std::vector<Vec3> corners;
  for (std::uint32_t p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    corners.clear();
    for (std::uint32_t c = 0; c < polygon.corner_count; ++c)
      corners.push_back(scene.vertices[scene.corners[polygon.first_corner + c]]);
    for (Facet& facet : facets_of(corners, patch_edge_m)) {
      facet.object = polygon.object;
      facet.material = polygon.material;
      facet.polygon = p;
      facet.both_sides = scene.materials[polygon.material].both_sides;
      if (!has_area(facet))
        ++dropped;
      else if (!use(facet))
        return dropped;
    }
  }
  return dropped;
}

api::Error without_area() {
  return {api::Fault::invalid_request, "no polygon of the scene has an area"};
}

}  // namespace

api::Result<Patches> mesh_into_patches(const Scene& scene, double patch_edge_m) {
  Patches patches;
  bool fits = true;
  patches.dropped_facets = for_each_facet(scene, patch_edge_m, [&](const Facet& facet) {
    fits = append(patches, facet);
    return fits;
  });
  if (!fits)
    return api::Error{api::Fault::out_of_resources, "the scene cuts into more than " +
                                                        std::to_string(kPatchesMax) +
                                                        " patches; choose a larger patch_edge_m"};
  if (patches.count() == 0) return without_area();
  return patches;
}

api::Result<PatchCount> count_patches(const Scene& scene, double patch_edge_m) {
  constexpr std::uint64_t kCountedMax = 1'000'000'000'000'000;  // 1e7 polygons of 1e12 cells would overflow
  PatchCount count;
  count.dropped_facets = for_each_facet(scene, patch_edge_m, [&](const Facet& facet) {
    const std::uint64_t cells = std::uint64_t{facet.grid_u} * facet.grid_v;
    count.patches = std::min(kCountedMax, count.patches + cells * (facet.both_sides ? 2 : 1));
    return true;
  });
  if (count.patches == 0) return without_area();
  return count;
}

}  // namespace engine
