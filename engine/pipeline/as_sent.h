// What is wrong with a job, told to whoever sent it in terms of what was sent.
#pragma once

#include <filesystem>

#include "api/job_report.h"
#include "api/result.h"

namespace engine {

/// `status` with the lines and columns that its violations point to in animation.json, and it and the
/// warnings of `report` with every file called as it was given (api/given_names.h).
api::Status as_sent(const std::filesystem::path& input_folder, api::Status status, api::JobReport& report);
api::Error as_sent(const std::filesystem::path& input_folder, api::Error error);

}  // namespace engine
