// The artefacts of a run, in the order the manifest lists them.
#pragma once

#include <filesystem>
#include <vector>

#include "api/job_request.h"
#include "engine/base/checkpoint.h"
#include "engine/image/shown_surfaces.h"
#include "engine/lighting/lit_scene.h"
#include "engine/output/artefacts.h"
#include "engine/pipeline/solve_sequence.h"

namespace engine {

/// The images of a run, and what they share with the data published after them.
struct PublishedImages {
  std::vector<Artefact> artefacts;
  ShownSurfaces surfaces;
  double auto_exposure = 1;  ///< auto_exposure_factor()
};

/// Renders every image the job asks for, into `folder`/images/<camera>/, and lists the files.
/// `folder` exists. An image that an earlier attempt at the same job has finished is left as it is, which
/// `checkpoints` tell; images of anything else are removed. Frames that were there are counted in `report`.
/// Errors: invalid_request for a camera that the animation lacks; stopped; disk_full; internal for other I/O
/// errors.
api::Result<PublishedImages> publish_images(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                                            const std::vector<api::ImageOptions>& images,
                                            const std::filesystem::path& folder, Checkpoints& checkpoints,
                                            StageClock& clock, api::JobReport& report);

/// Writes radiosity.npy, the other series, patches.npz, shading_mesh.npz and key_frames.json, and last of all
/// manifest.json, which lists these and `images`. Errors: disk_full; out_of_resources where an .npz would
/// exceed 4 GiB; internal for other I/O errors, and where one of `images` is not there.
api::Status publish_data(const LitScene& lit, const SolvedSequence& solved, const PublishedImages& images,
                         const api::JobRequest& request, const std::filesystem::path& folder);

}  // namespace engine
