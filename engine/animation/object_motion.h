// One object over time.
#pragma once

#include "api/scene_description.h"
#include "engine/animation/animation.h"

namespace engine {

/// The poses of an object in frames 0 .. frame_count - 1, equal neighbours merged, frames in which it is not
/// visible left out.
ObjectMotion motion_of(const api::ObjectAnimation& object, double metres_per_unit, FrameIndex frame_count);

}  // namespace engine
