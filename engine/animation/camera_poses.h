// One camera over time.
#pragma once

#include <vector>

#include "api/scene_description.h"
#include "engine/animation/animation.h"

namespace engine {

/// [frame]; see animate() for `up` and for a camera that stands on its target.
std::vector<CameraPose> poses_of(const api::Camera& camera, api::UpAxis up, double metres_per_unit,
                                 FrameIndex frame_count);

}  // namespace engine
