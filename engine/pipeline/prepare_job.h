// What comes before the light: the scene, its animation and its patches, checked. Of a run and of a view
// alike.
#pragma once

#include <filesystem>
#include <functional>

#include "api/job_report.h"
#include "api/job_request.h"
#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/base/progress.h"
#include "engine/patches/patches.h"
#include "engine/pipeline/forecast.h"
#include "engine/scene/scene.h"

namespace engine {

/// What a job is about, checked and not yet cut into patches.
struct PreparedJob {
  Scene scene;
  Animation animation;
  JobSize size;
};

/// All that can refuse a job, before anything that takes long or much memory. Fills the
/// warnings and counts of `report`.
api::Result<PreparedJob> prepare_job(const api::JobRequest& request,
                                     const std::filesystem::path& input_folder,
                                     const std::function<bool()>& stop_requested, api::JobReport& report);

/// As the layout says. Where it is `adaptive` the number of patches, of which only the most it can come to
/// was known, is then told to `report` and in `size`.
api::Result<Patches> cut_into_patches(const PreparedJob& job, const api::JobRequest& request,
                                      const Progress& progress, JobSize& size, api::JobReport& report);

}  // namespace engine
