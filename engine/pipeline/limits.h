// What one job may ask of a machine: a run stays under about 12 GiB of memory.
#pragma once

#include <string>

#include "api/job_request.h"
#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/patches/patches.h"

namespace engine {

/// What the series of radiosity (12 bytes per patch and frame) of a run may take together; lines take less
/// than 1 GiB, since a replicate has at most kLinesPerReplicateMax.  [bytes]
inline constexpr std::uint64_t kRunBytesMax = std::uint64_t{12} << 30;

/// Series that a run holds at once at most. With G = `groups` solutions (solved_groups): direct light and its
/// variance of each, 2 G; mean and scatter of the replicates, 2; a window's light, 2 G and 4 more; and of
/// each group that the job names its mean and what the replicate at work found, 2, and where all light is
/// interpolated its radiosity, 1.
std::uint64_t series_of_run(const api::LightingOptions& lighting, std::uint64_t groups);

/// The same of the estimate, on its own patches: radiosity, 1; direct light of each solution, G. Mode
/// `default`: of what is interpolated (each solution, or all light together) the replicates and their mean,
/// 9 each. Besides, a window's light, 6, or later what errors are weighed with, 1 each and 1.
std::uint64_t series_of_estimate(const api::LightingOptions& lighting, std::uint64_t groups);

/// Objects and cameras times frames, some 100 bytes each. patches.npz then stays below its 4 GiB.
inline constexpr std::uint64_t kPosesMax = 10'000'000;

/// Rays through the pixels of all images of a job. One image has 64 Mi pixels at most by its edges.
inline constexpr double kImageSamplesMax = 2e11;

/// A number in a message: three significant digits.
std::string rounded(double value);

/// What needs no mesh: poses, images. `object_count`: of the scene.
/// Error out_of_resources with a violation in animation.json for each limit that is exceeded.
api::Status check_request_size(const api::JobRequest& request, std::size_t object_count);

/// Patches that the layout `adaptive` may use: patch_count_max, and no more than a run can hold.
std::uint64_t patch_budget(const api::JobRequest& request, const Scene& scene, const Animation& animation);

struct MeshSizes {
  PatchCount fine;                   ///< of the lighting; layout `adaptive`: the most it can come to
  std::uint64_t coarse_patches = 0;  ///< of the estimate; 0 where the mode has none
};

/// Counts the patches of the lighting and, where the mode has one, of the estimate.
/// Errors: out_of_resources as above, where either is more than kPatchesMax or more than a run can hold in
/// `request.frame_count` frames (layout `adaptive`: at its coarsest, or more than patch_count_max);
/// invalid_request where no polygon has an area.
api::Result<MeshSizes> check_mesh_size(const api::JobRequest& request, const Scene& scene,
                                       const Animation& animation);

}  // namespace engine
