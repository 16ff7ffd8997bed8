// What one job may ask of a machine: a run stays under about 12 GiB of memory.
#pragma once

#include "api/job_request.h"
#include "api/result.h"
#include "engine/patches/patches.h"

namespace engine {

/// Radiosity of all patches in all frames. Of such series a run holds at worst, where nearly every frame is
/// solved, five while it composes the result: direct light and its columns of the solved frames, indirect
/// light, what arrives in every frame and the radiosity; and three while it solves, with three more of a
/// window of at most 64 frames. (Where few frames are solved: about three. Where all are: three.)  [bytes]
inline constexpr std::uint64_t kSeriesBytesMax = std::uint64_t{5} << 28;

/// The same of the estimate, which holds eight: direct light, its replicates, and three of a window.  [bytes]
inline constexpr std::uint64_t kEstimateSeriesBytesMax = std::uint64_t{1} << 30;

/// What a line's exchanges take while a window is traced: about 25 bytes per line and segment, so two or
/// three segments each. Scenes of many surfaces behind each other take more.  [bytes]
inline constexpr std::uint64_t kLineBytes = 64;
inline constexpr std::uint64_t kTracedBytesMax = std::uint64_t{4} << 30;

/// Objects and cameras times frames, some 100 bytes each. patches.npz then stays below its 4 GiB.
inline constexpr std::uint64_t kPosesMax = 10'000'000;

/// Rays through the pixels of all images of a job. One image has 64 Mi pixels at most by its edges.
inline constexpr double kImageSamplesMax = 2e11;

/// What needs no mesh: lines, poses, images. `object_count`: of the scene.
/// Error out_of_resources with a violation in animation.json for each limit that is exceeded.
api::Status check_request_size(const api::JobRequest& request, std::size_t object_count);

/// Patches that the layout `adaptive` may use: patch_count_max, and no more than a run can hold.
std::uint64_t patch_budget(const api::JobRequest& request);

struct MeshSizes {
  PatchCount fine;                   ///< of the lighting; layout `adaptive`: the most it can come to
  std::uint64_t coarse_patches = 0;  ///< of the estimate; 0 where the mode has none
};

/// Counts the patches of the lighting and, where the mode has one, of the estimate.
/// Errors: out_of_resources as above, where either is more than kPatchesMax or more than a run can hold in
/// `request.frame_count` frames (layout `adaptive`: at its coarsest, or more than patch_count_max);
/// invalid_request where no polygon has an area.
api::Result<MeshSizes> check_mesh_size(const api::JobRequest& request, const Scene& scene);

}  // namespace engine
