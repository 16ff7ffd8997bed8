// Files of uploads by what they hold, so that what is unchanged is not sent again.
//
// Nothing refers to them: a job has copies of its own, so that a blob may go at any time. They go when they
// have not been used for a while.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

struct BlobLimits {
  std::int64_t total_bytes = std::int64_t{8} << 30;  ///< of all blobs together
  std::chrono::seconds unused_max = std::chrono::hours(24);
};

/// Safe for use by several threads.
class Blobs {
 public:
  /// `folder` holds <first two digits>/<hash>; made when it is needed, on the file system of the uploads.
  Blobs(std::filesystem::path folder, BlobLimits limits);

  /// For reading; it counts as used from now on. Errors: not_found, internal.
  api::Result<FileHandle> open(std::string_view sha256) const;

  /// Moves the file `from`, written but not yet durable, to its place, where it is what `sha256` says. It is
  /// gone from `from` only on success. Errors: invalid_request (other bytes), over_quota, disk_full,
  /// internal.
  api::Status keep(const std::filesystem::path& from, std::string_view sha256);

  /// Removes what has not been used for `unused_max`. -> bytes that remain
  std::int64_t collect();

 private:
  std::filesystem::path path_of(std::string_view sha256) const;

  const std::filesystem::path folder_;
  const BlobLimits limits_;
  std::mutex keeping_;
};

}  // namespace server
