// What is close in front of a patch, and hides from it the light that comes from everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/base/progress.h"
#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// Cosine-weighted share of the directions in front of a patch in which nothing at rest is nearer than
/// `reach_m`, [patch], 0 .. 1  [-]. From kOpennessRays rays from points all over the patch. 1 of patches that
/// do not rest in one place. Each patch has its own random numbers from `seed`.
/// Error: stopped.
api::Result<std::vector<float>> openness(const Patches& patches, const Animation& animation,
                                         const StaticRays& static_rays, float reach_m, std::uint64_t seed,
                                         const Progress& progress);

inline constexpr std::uint32_t kOpennessRays = 16;

}  // namespace engine
