// The stages of a job, in order.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "api/job_report.h"
#include "api/job_request.h"
#include "api/progress_line.h"
#include "api/read_request.h"
#include "api/result.h"
#include "engine/base/checkpoint.h"

namespace engine {

/// How a run talks to the worker around it.
struct RunHooks {
  std::function<void(const api::ProgressLine&)> progress = [](const api::ProgressLine&) {};
  std::function<bool()> stop_requested = [] { return false; };  ///< asked at least every 100 ms of work
  /// Where a killed run leaves what the next one goes on from; removed when the run has succeeded. Empty:
  /// nothing is kept. The request must be that of animation.json in the input folder: what was saved is known
  /// to be of the same job by the bytes of that folder (and of this program).
  std::filesystem::path checkpoint_folder = {};
  std::chrono::milliseconds checkpoints_apart = Checkpoints::kApart;  ///< at least
  std::string fingerprint = {};  ///< job_fingerprint(input folder) of who knows it already
};

/// Solves the job whose inputs (scene.obj, MTL, textures) lie in `input_folder` and publishes its artefacts
/// in `artefacts_folder` (exists), manifest.json last. Fills `report` as far as it gets, also when it fails.
/// The same inputs give the same bytes in `artefacts_folder`, whatever the thread count.
api::Status run_pipeline(const api::JobRequest& request, const std::filesystem::path& input_folder,
                         const std::filesystem::path& artefacts_folder, const RunHooks& hooks,
                         api::JobReport& report);

/// What run_pipeline checks before it computes: loads the scene, evaluates the animation and counts the
/// patches, so that bad input and what is too much is refused before it is queued. Fills warnings, counts
/// ("polygons", "patches", "frames"), and the forecast of a run with so many threads (0: all cores).
/// Errors: those of load_scene, check_poses and check_*_size (limits.h).
api::Status check_job(const api::JobRequest& request, const std::filesystem::path& input_folder,
                      unsigned threads, api::JobReport& report);

/// Why a job is refused whose animation.json is wrong: as refuse_scene, the textures read.
api::Error refuse_job(const api::ReadRequest& read, const std::filesystem::path& input_folder,
                      const std::function<bool()>& stop_requested);

}  // namespace engine
