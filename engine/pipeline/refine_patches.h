// The adaptive layout: where light changes inside a patch, it is quartered.
#pragma once

#include <cstdint>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/base/progress.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace engine {

struct RefinedPatches {
  Patches patches;
  std::uint64_t cells_considered = 0;  ///< that were lit to see what quartering them would show
  std::uint64_t shadow_rays = 0;       ///< traced for it
};

/// A cell stays whole where in every frame spread x sqrt(area) is less than this times patch_edge_m. Its
/// spread is the standard deviation of what its quarters reflect, relative to max(theirs, half the mean of
/// the scene); the product's square is its share of the square error, so that large cells are quartered for
/// less. A cell of patch_edge_m: for a spread of 4 %.  [-]
inline constexpr double kSpread = 0.04;

/// What else than direct light arrives is not known yet. It is taken to be the same from everywhere, and
/// hidden by what is nearer than this times patch_edge_m (openness.h): under lamps that hang close to a
/// ceiling, and where things stand on each other.  [-]
inline constexpr double kHidingReach = 0.5;

/// Shadow rays per quarter and light. Their noise is taken for spread: there is some only where a light is
/// partly hidden, which is where light changes; taken off, edges that cut off a corner of a cell drown in it.
inline constexpr std::uint32_t kRefineSamples = 4;

/// Begins with mesh_into_patches(scene, adaptive) and quarters cells, those first whose spread^2 (mean of all
/// frames) x area per new patch is largest: that lowers the mean square difference between patches and light
/// most. Ends where no cell is worth it, or `patch_count_max` patches would be exceeded. Each level's cells
/// are lit as quarters in all frames; only those of cells that are worth quartering go on to the next.
/// Cells beside small ones are then quartered too, see grade(). Costs about as many shadow rays as the direct
/// light of the result with 16 samples.
///
/// patch_count_max: 1 .. kPatchesMax
/// Errors: out_of_resources with a violation at /lighting/patch_count_max where the coarse mesh alone is more
/// than that; as mesh_into_patches; stopped.
api::Result<RefinedPatches> refine_patches(const Scene& scene, const Animation& animation,
                                           const api::LightingOptions& lighting,
                                           std::uint64_t patch_count_max, const Progress& progress);

}  // namespace engine
