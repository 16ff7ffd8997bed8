// How far apart things are.
#pragma once

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"

namespace engine {

/// Diagonal of a box that holds every facet in every frame of the animation, and a little more  [m]
float scene_reach_m(const Patches& patches, const Animation& animation);

}  // namespace engine
