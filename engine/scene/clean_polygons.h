// What a polygon mesh needs before light can be computed on it.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace engine {

/// Merges neighbouring corners at the same point and drops polygons that have no area left: under 3 corners,
/// or an area below 1e-7 of the square of the longest edge (single precision tells nothing finer). Counts are
/// added to scene.warnings, and a warning if the scene's extent is over 1e6 times its shortest edge.
void clean_polygons(Scene& scene);

}  // namespace engine
