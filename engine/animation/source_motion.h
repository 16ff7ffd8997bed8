// One light without a surface over time.
#pragma once

#include <string>

#include "api/scene_description.h"
#include "engine/animation/emission.h"

namespace engine {

/// The light `name` of `description.lights`, in frames 0 .. frame_count - 1.
///
/// Its parent's pose is applied to position and direction, the direction without the translation. In frames
/// in which the parent is not there the intensity is zero and the rest is as in the frame before, or in the
/// first in which it is there. Where a direction vanishes between two opposite keys, it is that of the frame
/// before. A cubic intensity is held at >= 0.
SourceMotion source_motion_of(const std::string& name, const api::SceneDescription& description,
                              FrameIndex frame_count);

}  // namespace engine
