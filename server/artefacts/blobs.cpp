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

Blobs::Blobs(fs::path folder, BlobLimits limits) : folder_(std::move(folder)), limits_(limits) {}

fs::path Blobs::path_of(std::string_view sha256) const {
  return folder_ / sha256.substr(0, 2) / sha256;
}

api::Result<FileHandle> Blobs::open(std::string_view sha256) const {
  auto file = open_below(folder_, std::string(sha256.substr(0, 2)) + "/" + std::string(sha256));
  if (!file) return file;
  (void)::futimens(file->get(), nullptr);  // where that fails it goes a little earlier
  return file;
}

api::Status Blobs::keep(const fs::path& from, std::string_view sha256) {
  const FileHandle file(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file) return file_error(from.string(), errno);
  const auto hash = sha256_of(file);
  if (!hash) return hash.error();
  if (*hash != sha256)
    return api::Error{api::Fault::invalid_request,
                      "the bytes have another hash",
                      {{"body", "", 0, 0, "wrong_hash", "the SHA-256 of what was sent is " + *hash}}};
  const auto bytes = size_of(file);
  if (!bytes) return bytes.error();
  const std::lock_guard lock(keeping_);
  if (collect() + *bytes > limits_.total_bytes)
    return api::Error{api::Fault::over_quota, "all blobs together may be " +
                                                  std::to_string(limits_.total_bytes) +
                                                  " bytes; they go when they have not been used for a day"};
  if (::fsync(file.get()) != 0) return file_error("keep a blob", errno);
  const fs::path to = path_of(sha256);
  if (const api::Status made = make_folders(to.parent_path()); !made) return made;
  if (::rename(from.c_str(), to.c_str()) != 0) return file_error("keep a blob", errno);
  return sync_folder(to.parent_path());
}

std::int64_t Blobs::collect() {
  std::error_code error;
  std::int64_t kept = 0;
  const auto oldest = fs::file_time_type::clock::now() - limits_.unused_max;
  for (fs::recursive_directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;
    if (!fs::is_regular_file(at->symlink_status(gone))) continue;
    const auto used = at->last_write_time(gone);
    const auto bytes = static_cast<std::int64_t>(at->file_size(gone));
    if (gone) continue;
    if (used >= oldest || !fs::remove(at->path(), gone)) kept += bytes;
  }
  return kept;
}

}  // namespace server
