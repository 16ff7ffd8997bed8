#include "engine/image/shown_surfaces.h"

#include <utility>

#include "engine/image/corner_normals.h"

namespace engine {

ShownSurfaces shown_surfaces(const Scene& scene, const Patches& patches, const Animation& animation,
                             const StaticRays& static_rays) {
  ShadingMesh mesh = build_shading_mesh(patches, corner_normals(scene, patches));
  Uncovered uncovered = find_uncovered(patches, animation, static_rays, mesh);
  return {std::move(mesh), std::move(uncovered)};
}

}  // namespace engine
