// animation.json as far as it can be read, for who looks on for what else is wrong with a job.
#pragma once

#include <string_view>
#include <vector>

#include "api/job_request.h"
#include "api/result.h"

namespace api {

struct ReadRequest {
  JobRequest request;                 ///< whole only where there are no violations
  bool is_document = false;           ///< false: this is no JSON, and `request` says nothing
  std::vector<Violation> violations;  ///< every one, up to kViolationsMax
};

/// As parse_job_request, also where something is wrong. Defined in api/json/.
ReadRequest read_request(std::string_view bytes, std::string_view file = "animation.json");

}  // namespace api
