// The routes of results, a part in each file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/result_answers.h"
#include "server/http/router.h"
#include "server/jobs/job_service.h"

namespace server {

/// Radiosity as numbers: frames as JSON and CSV, patches over time.
void add_radiosity_routes(Router& router, JobService& jobs);
/// radiosity.npz, results.tar, and a frame as glTF.
void add_bundle_routes(Router& router, JobService& jobs);

/// "frame-0007-radiosity.csv"
std::string frame_file(std::uint32_t frame, std::string_view rest);

}  // namespace server
