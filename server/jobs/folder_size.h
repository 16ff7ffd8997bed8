// What a folder takes on disk.
#pragma once

#include <cstdint>
#include <filesystem>

namespace server {

/// A folder with more is not looked at to its end.
struct FolderBounds {
  std::int64_t files = INT64_MAX;  ///< folders count too
  int depth = 64;                  ///< of folders in folders; each open one takes a descriptor
};

struct FolderSize {
  std::int64_t bytes = 0;  ///< of the files' contents; links are not followed
  std::int64_t files = 0;
  std::int64_t on_disk_bytes = 0;  ///< less than `bytes` where files have holes
  bool beyond = false;             ///< there is more than the bounds allow; the rest is not counted
};

/// What cannot be read counts as nothing: files may go while we look.
FolderSize size_of_folder(const std::filesystem::path& folder, const FolderBounds& bounds = {});

}  // namespace server
