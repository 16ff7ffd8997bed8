// What it takes to make a job's results again, and to see that they are the same.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
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

/// Those that were asked for are kept, some of them. Safe for use by several threads.
class Reproductions {
 public:
  /// Errors: not_found where the job has not succeeded; internal. Of a job of before inputs had hashes it
  /// reads them, for their hashes as they are now.
  api::Result<std::shared_ptr<const Reproduction>> of(JobService& jobs, const Job& job);

 private:
  static constexpr std::size_t kMax = 64, kBytesMax = 16u << 20;

  std::mutex mutex_;
  std::map<std::pair<std::int64_t, std::string>, std::shared_ptr<const Reproduction>> known_;
  std::size_t bytes_ = 0;
};

}  // namespace server
