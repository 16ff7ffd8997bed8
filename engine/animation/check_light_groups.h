// Do the groups of lights that a job names have lights?
#pragma once

#include <string>
#include <vector>

#include "api/job_request.h"
#include "api/result.h"
#include "engine/animation/animation.h"

namespace engine {

/// Adds to `warnings` for every group of lights in which nothing ever emits.
/// Error invalid_request: a violation unknown_light in animation.json for every name in
/// `request.lighting.light_groups` that is neither a material of the scene nor a light, up to kViolationsMax.
api::Status check_light_groups(const Scene& scene, const Animation& animation, const api::JobRequest& request,
                               std::vector<std::string>& warnings);

}  // namespace engine
