#include "server/artefacts/blobs.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "server/artefacts/verify.h"

namespace server {
namespace {

namespace fs = std::filesystem;

api::Status make_folders(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return file_error(folder.string(), error.value());
  for (const fs::path& path : {folder.parent_path(), folder.parent_path().parent_path()})
    if (const api::Status synced = sync_folder(path); !synced) return synced;
  return api::Done{};
}

}  // namespace

fs::path Blobs::path_of(std::string_view sha256) const {
  return folder_ / sha256.substr(0, 2) / sha256;
}

api::Result<FileHandle> Blobs::open(std::string_view sha256) const {
  return open_below(folder_, std::string(sha256.substr(0, 2)) + "/" + std::string(sha256));
}

bool Blobs::has(std::string_view sha256) const {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(path_of(sha256), error));
}

api::Result<std::int64_t> check_blob(const fs::path& path, std::string_view sha256) {
  const auto file = open_below(path.parent_path(), path.filename().string());
  if (!file) return file.error();
  const auto hash = sha256_of(*file);
  if (!hash) return hash.error();
  if (*hash != sha256)
    return api::Error{api::Fault::invalid_request,
                      "the bytes have another hash",
                      {{"body", "", 0, 0, "wrong_hash", "the SHA-256 of what was sent is " + *hash}}};
  return size_of(*file);
}

api::Status Blobs::keep(const fs::path& from, std::string_view sha256) {
  const FileHandle file(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file) return file_error(from.string(), errno);
  if (::fsync(file.get()) != 0) return file_error("keep a blob", errno);
  const fs::path to = path_of(sha256);
  if (const api::Status made = make_folders(to.parent_path()); !made) return made;
  if (::rename(from.c_str(), to.c_str()) != 0) return file_error("keep a blob", errno);
  return sync_folder(to.parent_path());
}

void Blobs::keep_only(const std::set<std::string, std::less<>>& hashes) {
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;
    if (fs::is_directory(at->symlink_status(gone)) || hashes.contains(at->path().filename().string()))
      continue;
    fs::remove(at->path(), gone);  // what stays now goes next time
  }
}

}  // namespace server
