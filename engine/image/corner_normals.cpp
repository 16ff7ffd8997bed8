#include "engine/image/corner_normals.h"

#include "engine/patches/texture_reflectance.h"

namespace engine {

std::vector<CornerNormals> corner_normals(const Scene& scene, const Patches& patches) {
  std::vector<CornerNormals> normals;
  if (scene.corner_normals.empty()) return normals;
  normals.reserve(patches.facets.size());
  for (const Facet& facet : patches.facets) {
    normals.push_back({facet.normal, facet.normal, facet.normal, facet.normal});
    if (scene.corner_normals[scene.polygons[facet.polygon].first_corner] == kNoIndex) continue;
    const auto corners = polygon_corners(scene, facet);
    for (std::size_t k = 0; k < (facet.is_triangle ? 3 : 4); ++k) {
      const Vec3 normal = scene.normals[scene.corner_normals[corners[k]]];
      normals.back()[k] = dot(normal, facet.normal) < 0 ? -normal : normal;
    }
  }
  return normals;
}

Vec3 shading_normal(const Patches& patches, std::span<const CornerNormals> of_facets,
                    std::uint32_t facet_index, float u, float v) {
  const Facet& facet = patches.facets[facet_index];
  if (of_facets.empty()) return facet.normal;
  const CornerNormals& n = of_facets[facet_index];
  const Vec3 sum = facet.is_triangle
                       ? (1 - u - v) * n[0] + u * n[1] + v * n[2]
                       : (1 - v) * ((1 - u) * n[0] + u * n[1]) + v * ((1 - u) * n[3] + u * n[2]);
  return dot(sum, sum) > 1e-12f ? normalized(sum) : facet.normal;
}

}  // namespace engine
