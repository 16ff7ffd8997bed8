// What it takes to make a job's results again, and to see that they are the same.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/jobs/job_service.h"

namespace server {

struct HashedFile {
  std::string path;  ///< within its folder
  std::int64_t bytes = 0;
  std::string sha256;
};

struct Reproduction {
  std::vector<HashedFile> inputs;
  std::vector<HashedFile> artefacts;  ///< and manifest.json
  /// api/openapi.yaml, components/schemas/Reproduction: the program's version, the inputs and artefacts with
  /// their hashes, and the lighting options as they were given, with the seed that they come to.
  std::string json;
  /// As `sha256sum --check` reads it: of all files of both folders, and of reproduce.json.
  std::string sums;
};

/// Reads the inputs once, for their hashes. Errors: not_found where the job has not succeeded; internal.
api::Result<Reproduction> reproduction_of(JobService& jobs, const Job& job);

}  // namespace server
