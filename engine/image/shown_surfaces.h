// What of a scene's surfaces pictures need beside patches: the same for all cameras and frames.
#pragma once

#include "engine/animation/animation.h"
#include "engine/image/shading_mesh.h"
#include "engine/image/uncovered.h"
#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

struct ShownSurfaces {
  ShadingMesh mesh;
  Uncovered uncovered;
};

ShownSurfaces shown_surfaces(const Scene& scene, const Patches& patches, const Animation& animation,
                             const StaticRays& static_rays);

}  // namespace engine
