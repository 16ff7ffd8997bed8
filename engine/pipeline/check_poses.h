// Where the animation puts things: not so far away that single precision loses them.
#pragma once

#include <string>
#include <vector>

#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/scene/scene.h"

namespace engine {

/// Coordinates of anything in any frame: products of a few of them stay far below the largest float.  [m]
inline constexpr double kCoordinateMax = 1e7;

/// A box of everything in all frames that is so many times larger than that of what never moves is warned
/// about: global lines are spread over the large one, and few meet the small one.
inline constexpr double kSpreadMax = 1e3;

/// The step of a float at an object's largest coordinate, relative to its shortest edge, beyond which is a
/// warning: normals are then off by so many radians.
inline constexpr double kRoundingMax = 1e-3;

/// Places the box of every object (so a point of its corners, not of its surface, is what counts), every
/// light and every camera in each frame, parents included. Adds to `warnings`. Error invalid_request with a
/// violation out_of_range in animation.json for every object, light and camera beyond kCoordinateMax, up to
/// kViolationsMax.
api::Status check_poses(const Scene& scene, const Animation& animation, std::vector<std::string>& warnings);

}  // namespace engine
