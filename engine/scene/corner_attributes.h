// Texture coordinates and normals of corners, as far as images can use them.
#pragma once

#include "engine/scene/scene.h"

namespace engine {

/// Makes Scene::corner_uvs and corner_normals what scene.h promises: a polygon of which a corner has none, or
/// a normal of zero, has none at all; what then nobody refers to is freed, and texture coordinates too where
/// no material has a texture. Warns about polygons with a texture and no coordinates.
void settle_corner_attributes(Scene& scene);

}  // namespace engine
