// The scene of a job before it is lit: what a browser shows of an upload.
#pragma once

#include <cstdint>
#include <filesystem>

#include "api/job_report.h"
#include "api/job_request.h"
#include "api/result.h"

namespace engine {

/// What a preview may have: sides of facets, and bytes of its file.
inline constexpr std::uint64_t kPreviewPatchesMax = 1'000'000;
inline constexpr std::uint64_t kPreviewBytesMax = 256u << 20;

/// Checks a job as check_job() does, but for the forecast, and writes `file` (see write_shading_mesh_npz):
/// every side of a facet is one patch, between the nodes at its corners; auto_exposure and half_scale are 1.
/// Errors: those of check_job; out_of_resources, code limit_exceeded, beyond the limits above.
api::Status preview_job(const api::JobRequest& request, const std::filesystem::path& input_folder,
                        const std::filesystem::path& file, api::JobReport& report);

}  // namespace engine
