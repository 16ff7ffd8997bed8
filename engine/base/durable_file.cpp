#include "engine/base/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "api/fault_point.h"

namespace engine {

api::Error file_error(std::string_view action, const std::filesystem::path& path, int errno_value) {
  const bool full = errno_value == ENOSPC || errno_value == EDQUOT;
  return {full ? api::Fault::disk_full : api::Fault::internal,
          "cannot " + std::string(action) + " '" + path.string() +
              "': " + std::generic_category().message(errno_value)};
}

DurableFile::DurableFile(std::filesystem::path path, std::filesystem::path temporary, int descriptor)
    : path_(std::move(path)), temporary_(std::move(temporary)), descriptor_(descriptor) {}

DurableFile::DurableFile(DurableFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      end_bytes_(other.end_bytes_) {}

DurableFile::~DurableFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

api::Result<DurableFile> DurableFile::create(const std::filesystem::path& path) {
  const auto temporary = path.parent_path() / (".tmp." + path.filename().string());
  // A killed attempt may have left one; O_EXCL then makes sure that it is a new file of ours, no link.
  ::unlink(temporary.c_str());
  const int descriptor =
      ::open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (descriptor < 0) return file_error("create", temporary, errno);
  return DurableFile(path, temporary, descriptor);
}

api::Status DurableFile::write_at(std::uint64_t offset_bytes, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset_bytes));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return file_error("write", temporary_, errno);
    offset_bytes += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return api::Done{};
}

api::Status DurableFile::append(std::string_view bytes) {
  const auto written = write_at(end_bytes_, bytes);
  if (written) end_bytes_ += bytes.size();
  return written;
}

api::Status DurableFile::publish() {
  // A failed fsync is never tried again: the kernel may already have dropped the pages.
  const auto fail = [&](std::string_view action, int errno_value) -> api::Status {
    ::unlink(temporary_.c_str());
    return file_error(action, temporary_, errno_value);
  };
  const int synced = ::fsync(descriptor_) == 0 ? 0 : errno;
  const int closed = ::close(std::exchange(descriptor_, -1)) == 0 ? 0 : errno;
  if (synced != 0) return fail("fsync", synced);
  if (closed != 0) return fail("close", closed);
  api::fault_point("file_written");
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return fail("rename", errno);
  api::fault_point("file_renamed");
  return api::Done{};
}

api::Status sync_folder(const std::filesystem::path& folder) {
  const auto path = folder.empty() ? std::filesystem::path(".") : folder;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return file_error("open", path, errno);
  const int synced = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (synced != 0) return file_error("fsync", path, synced);
  return api::Done{};
}

}  // namespace engine
