// Frames between which light jumps, so that nothing may be interpolated across.
#pragma once

#include <span>
#include <vector>

#include "engine/animation/light_groups.h"

namespace engine {

/// The frames f - 1 and f on both sides of every jump, increasing: an object appears or disappears; a light
/// of a group's emission is switched, or a material's reflectance: from one frame to the next some channel
/// changes by more than half of the largest value that it has in any frame. (A ramp takes two frames at
/// least, so its steps are never more than half. Lesser steps are left to the search for keys.) What a
/// group's scale does is no jump: it is not interpolated.
std::vector<FrameIndex> frames_at_jumps(const Animation& animation, std::span<const LightGroup> groups);

}  // namespace engine
