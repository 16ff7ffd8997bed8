// What pictures a job was asked for: its cameras and how each is shown.
#pragma once

#include <memory>
#include <vector>

#include "api/image_options.h"
#include "api/view_request.h"
#include "server/jobs/job_service.h"

namespace server {

struct JobPictures {
  api::ViewedJob viewed;
  std::vector<api::ImageOptions> images;  ///< at most one per camera

  /// None: the job has no picture of it.
  const api::ImageOptions* of(std::string_view camera) const;
};

/// From its animation.json. The last few are remembered. Errors: internal.
api::Result<std::shared_ptr<const JobPictures>> pictures_of(JobService& jobs, const Job& job);

}  // namespace server
