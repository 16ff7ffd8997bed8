// Files that are either whole or absent, also after a crash or a power cut.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "api/result.h"

namespace engine {

/// A file under construction: ".tmp.<name>" beside its final name, which it gets by publish() only. What a
/// killed process left under the temporary name is replaced. Destroying an unpublished file removes it.
/// Errors of every call: disk_full when the disk (or the quota) is full, internal with path and reason
/// otherwise.
class DurableFile {
 public:
  /// `path`: final name; its folder exists.
  static api::Result<DurableFile> create(const std::filesystem::path& path);
  ~DurableFile();
  DurableFile(DurableFile&& other) noexcept;
  DurableFile& operator=(DurableFile&&) = delete;

  api::Status append(std::string_view bytes);
  /// Does not move the end that append() writes to.
  api::Status write_at(std::uint64_t offset_bytes, std::string_view bytes);

  /// fsync, close, rename. The name itself is durable after sync_folder() only, so that many files of one
  /// folder can share that call.
  api::Status publish();

 private:
  DurableFile(std::filesystem::path path, std::filesystem::path temporary, int descriptor);

  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;  ///< -1: closed
  std::uint64_t end_bytes_ = 0;
};

/// Makes renames within `folder` durable.
api::Status sync_folder(const std::filesystem::path& folder);

/// The Error for a failed system call on `path`; `action` completes "cannot ...".
api::Error file_error(std::string_view action, const std::filesystem::path& path, int errno_value);

}  // namespace engine
