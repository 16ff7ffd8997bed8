// Files of uploads by what they hold, so that what is unchanged is not sent again.
//
// Nothing refers to them: a job has copies of its own, so that a blob may go at any time. Whose they are, and
// for how long they stay, is the store's to know: JobService.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// Safe for use by several threads.
class Blobs {
 public:
  /// `folder` holds <first two digits>/<hash>; made when it is needed, on the file system of the uploads.
  explicit Blobs(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// For reading. Errors: not_found, internal.
  api::Result<FileHandle> open(std::string_view sha256) const;
  bool has(std::string_view sha256) const;

  /// Moves the file `from`, which is what `sha256` says, to its place, over the same bytes if they are there.
  /// Durable. Errors: disk_full, internal.
  api::Status keep(const std::filesystem::path& from, std::string_view sha256);

  /// Removes all others.
  void keep_only(const std::set<std::string, std::less<>>& hashes);

 private:
  std::filesystem::path path_of(std::string_view sha256) const;

  const std::filesystem::path folder_;
};

/// -> its size. Errors: not_found, invalid_request where its bytes have another hash, internal.
api::Result<std::int64_t> check_blob(const std::filesystem::path& file, std::string_view sha256);

}  // namespace server
