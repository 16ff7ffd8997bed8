// Where the data folder lies is nobody's business who reads what a worker has written.
#pragma once

#include <string>
#include <string_view>

#include "api/job_report.h"

namespace server {

/// Paths below `folder` told from there: "/data/jobs/job_1/input/scene.obj" -> "input/scene.obj", the folder
/// itself -> ".".
std::string without_folder(std::string_view text, std::string_view folder);

/// Of all that a report says in words.
void leave_out_folder(std::string_view folder, api::JobReport& report);

}  // namespace server
