// What a folder takes on disk.
#pragma once

#include <cstdint>
#include <filesystem>

namespace server {

struct FolderSize {
  std::int64_t bytes = 0;  ///< of the files' contents; links are not followed
  std::int64_t files = 0;
};

/// What cannot be read counts as nothing: files may go while we look.
FolderSize size_of_folder(const std::filesystem::path& folder);

}  // namespace server
