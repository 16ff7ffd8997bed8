#include "server/jobs/folder_size.h"

#include <system_error>

namespace server {

FolderSize size_of_folder(const std::filesystem::path& folder) {
  FolderSize size;
  std::error_code error;
  std::filesystem::recursive_directory_iterator at(folder, error);
  while (!error && at != std::filesystem::recursive_directory_iterator()) {
    std::error_code of_file;
    if (at->symlink_status(of_file).type() == std::filesystem::file_type::regular && !of_file) {
      const auto bytes = at->file_size(of_file);
      if (!of_file) size.bytes += static_cast<std::int64_t>(bytes);
      ++size.files;
    }
    at.increment(error);
  }
  return size;
}

}  // namespace server
