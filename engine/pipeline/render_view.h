// Pictures from the stored radiosity of a finished job: any camera, size, frames and exposure, without
// solving.
#pragma once

#include <filesystem>

#include "api/job_report.h"
#include "api/job_request.h"
#include "api/result.h"
#include "api/view_request.h"
#include "engine/base/progress.h"

namespace engine {

/// Where a job lies and where its view goes.
struct ViewFolders {
  std::filesystem::path input;      ///< scene.obj, MTL, textures
  std::filesystem::path artefacts;  ///< radiosity.npy and patches.npz of a run of this job
  std::filesystem::path view;       ///< exists; gets 0000.png, 0000.jpg, 0000.exr, ... and last manifest.json
};

/// The pictures that a run with these images would have made, byte for byte (but for `light_gains`, which
/// make lights as many times as bright, at the exposure of the job): what is shown follows from the input,
/// which is read again, and from the radiosity. `request` is the job's. Memory: that of the scene, and 12
/// bytes per patch and frame of the view. Errors: those of a run before it computes; wrong_state where
/// radiosity and patches are not those of this input; stopped; disk_full; internal.
api::Status render_view(const api::JobRequest& request, const api::ViewRequest& view,
                        const ViewFolders& folders, const Progress& progress, api::JobReport& report);

}  // namespace engine
