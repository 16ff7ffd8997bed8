// The routes of results, a part in each file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/job_json.h"
#include "server/http/result_answers.h"
#include "server/http/router.h"
#include "server/http/shown_as.h"
#include "server/jobs/job_service.h"
#include "server/workers/view_service.h"

namespace server {

/// Radiosity as numbers: frames as JSON and CSV, patches over time.
void add_radiosity_routes(Router& router, JobService& jobs);
/// Pictures of a job that is still at work.
void add_early_routes(Router& router, JobService& jobs);
HttpAnswer early_picture(JobService& jobs, const Job& job, const HttpRequest& request, std::uint32_t frame,
                         const std::string& extension);
/// Radiosity as half floats.
void add_half_routes(Router& router, JobService& jobs);
/// radiosity.npz, results.tar, and a frame as glTF.
void add_bundle_routes(Router& router, JobService& jobs);

struct WantedPicture {
  std::string camera;
  std::uint32_t frame = 0;
  std::string extension;  ///< "png", "jpg", "exr"
};
/// The picture as `exposure` and `tone_map` of the request want it, from the job or a view of it; else a 404
/// that says which view to POST. `views`: null where there are none.
HttpAnswer picture_answer(JobService& jobs, ViewService* views, const Job& job, const HttpRequest& request,
                          const WantedPicture& wanted);

/// "0007.png"
std::string image_file(std::uint32_t frame, std::string_view extension);

/// "frame-0007-radiosity.csv"
std::string frame_file(std::uint32_t frame, std::string_view rest);

}  // namespace server
