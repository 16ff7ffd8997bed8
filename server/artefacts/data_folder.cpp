#include "server/artefacts/data_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <set>
#include <system_error>
#include <vector>

#include "api/fault_point.h"

namespace server {
namespace {

constexpr mode_t kPrivateFolder = 0700;
constexpr const char* kBallast = "ballast";

api::Status make_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), kPrivateFolder) != 0 && errno != EEXIST)
    return file_error("make folder " + folder.string(), errno);
  return api::Done{};
}

std::string holder_of(const FileHandle& lock) {
  std::array<char, 32> text{};
  const ssize_t count = ::pread(lock.get(), text.data(), text.size() - 1, 0);
  if (count <= 0) return "unknown";
  std::string pid(text.data(), static_cast<std::size_t>(count));
  return pid.substr(0, pid.find('\n'));
}

api::Result<FileHandle> take_lock(const std::filesystem::path& file) {
  FileHandle lock(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!lock) return file_error(file.string(), errno);
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return file_error(file.string(), errno);
    return api::Error{
        api::Fault::wrong_state,
        file.parent_path().string() + " is in use by another server, process " + holder_of(lock)};
  }
  if (::ftruncate(lock.get(), 0) != 0) return file_error(file.string(), errno);
  // For people only, so a full disk is no reason to stay away.
  (void)write_all(lock, std::to_string(::getpid()) + "\n");
  return lock;
}

api::Result<std::vector<std::filesystem::path>> entries_of(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> entries;
  std::filesystem::directory_iterator at(folder, error);
  while (!error && at != std::filesystem::directory_iterator()) {
    entries.push_back(at->path());
    at.increment(error);
  }
  if (error) return file_error(folder.string(), error.value());
  return entries;
}

}  // namespace

api::Result<DataFolder> DataFolder::open(const std::filesystem::path& root) {
  std::error_code error;
  DataFolder folder;
  folder.root_ = std::filesystem::absolute(root, error);
  if (error) return file_error(root.string(), error.value());
  std::filesystem::create_directories(folder.root_.parent_path(), error);
  if (error) return file_error(root.string(), error.value());
  for (const auto& path : {folder.root_, folder.uploads(), folder.jobs()})
    if (const api::Status made = make_folder(path); !made) return made.error();
  auto lock = take_lock(folder.root_ / "LOCK");
  if (!lock) return lock.error();
  folder.lock_ = std::move(*lock);
  folder.room_ =
      std::make_shared<DiskRoom>([uploads = folder.uploads()] { return free_bytes(uploads); }, kRoomBytesMin);
  for (const auto& path : {folder.root_, folder.root_.parent_path()})
    if (const api::Status synced = sync_folder(path); !synced) return synced.error();
  return folder;
}

void DataFolder::lay_ballast() const {
  const std::filesystem::path file = root_ / kBallast;
  struct stat about {};
  if (::stat(file.c_str(), &about) == 0 && about.st_size == kBallastBytes) return;
  const auto free = free_bytes(root_);
  if (!free || *free < 2 * kRoomBytesMin + kBallastBytes) return;
  const FileHandle made(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (made && ::posix_fallocate(made.get(), 0, kBallastBytes) != 0) ::unlink(file.c_str());
}

bool DataFolder::drop_ballast() const {
  return ::unlink((root_ / kBallast).c_str()) == 0;
}

api::Status DataFolder::remove_leftovers(std::span<const std::string> ids_with_row) const {
  const std::set<std::string, std::less<>> known(ids_with_row.begin(), ids_with_row.end());
  api::Status status = api::Done{};
  for (const auto& parent : {uploads(), jobs()}) {
    const auto entries = entries_of(parent);
    if (!entries) return entries.error();
    for (const auto& entry : *entries) {
      if (parent == jobs() && known.contains(entry.filename().string())) continue;
      if (api::Status removed = remove_tree(entry); !removed) status = std::move(removed);
      api::fault_point("leftover_removed");
    }
  }
  return status;
}

api::Status has_room(const std::filesystem::path& folder) {
  const auto free = free_bytes(folder);
  if (!free) return free.error();
  if (*free < kRoomBytesMin)
    return api::Error{api::Fault::disk_full, "the disk is full: " + std::to_string(*free) +
                                                 " bytes are free, " + std::to_string(kRoomBytesMin) +
                                                 " are needed"};
  return api::Done{};
}

api::Result<std::int64_t> free_bytes(const std::filesystem::path& folder) {
  struct statvfs information {};
  if (::statvfs(folder.c_str(), &information) != 0) return file_error(folder.string(), errno);
  return static_cast<std::int64_t>(information.f_bavail) * static_cast<std::int64_t>(information.f_frsize);
}

}  // namespace server
