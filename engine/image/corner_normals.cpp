#include "engine/image/corner_normals.h"

namespace engine {

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
