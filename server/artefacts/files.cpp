#include "server/artefacts/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace server {
namespace {

constexpr std::size_t kPathBytesMax = 512;

bool is_plain_name(std::string_view name) {
  if (name.empty() || name == "." || name == "..") return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 && byte != 0x7f && c != '\\' && c != '/';
  });
}

FileHandle open_at(int folder, const std::string& name, int flags) {
  return FileHandle(::openat(folder, name.c_str(), flags | O_CLOEXEC | O_NOFOLLOW));
}

}  // namespace

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = other.release();
  }
  return *this;
}

int FileHandle::release() {
  return std::exchange(descriptor_, -1);
}

void FileHandle::close() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

api::Error file_error(std::string_view what, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT;
  return {full ? api::Fault::disk_full : api::Fault::internal,
          std::string(what) + ": " + std::generic_category().message(error_number)};
}

bool is_plain_relative_path(std::string_view path) {
  if (path.size() > kPathBytesMax) return false;
  for (;;) {
    const std::size_t slash = path.find('/');
    if (!is_plain_name(path.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    path.remove_prefix(slash + 1);
  }
}

api::Result<FileHandle> open_below(const std::filesystem::path& folder, std::string_view relative) {
  const std::string name(relative);
  if (!is_plain_relative_path(relative))
    return api::Error{api::Fault::invalid_request, "'" + name + "' is not a plain relative path"};
  FileHandle at(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  std::string_view rest = relative;
  for (std::size_t slash; at && (slash = rest.find('/')) != std::string_view::npos;
       rest.remove_prefix(slash + 1))
    at = open_at(at.get(), std::string(rest.substr(0, slash)), O_RDONLY | O_DIRECTORY);
  // O_NONBLOCK: a FIFO in that place must not hang the server.
  if (at) at = open_at(at.get(), std::string(rest), O_RDONLY | O_NONBLOCK);
  if (!at) {
    if (errno == ENOENT || errno == ENOTDIR || errno == ELOOP)
      return api::Error{api::Fault::not_found, "there is no file '" + name + "'"};
    return file_error(name, errno);
  }
  struct stat information {};
  if (::fstat(at.get(), &information) != 0) return file_error(name, errno);
  if (!S_ISREG(information.st_mode)) return api::Error{api::Fault::not_found, "'" + name + "' is not a file"};
  return at;
}

api::Result<std::int64_t> size_of(const FileHandle& file) {
  struct stat information {};
  if (::fstat(file.get(), &information) != 0) return file_error("size of a file", errno);
  return std::int64_t{information.st_size};
}

api::Result<std::string> read_below(const std::filesystem::path& folder, std::string_view relative,
                                    std::int64_t bytes_max) {
  const auto file = open_below(folder, relative);
  if (!file) return file.error();
  const auto size = size_of(*file);
  if (!size) return size.error();
  if (*size > bytes_max)
    return api::Error{api::Fault::invalid_request, std::string(relative) + " is " + std::to_string(*size) +
                                                       " bytes, at most " + std::to_string(bytes_max) +
                                                       " are allowed"};
  std::string bytes(static_cast<std::size_t>(*size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(file->get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return file_error(relative, errno);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

api::Status write_all(const FileHandle& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return file_error("write", errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return api::Done{};
}

api::Status write_durably(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path temporary = path.parent_path() / (".tmp." + path.filename().string());
  {
    const FileHandle file(
        ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!file) return file_error(path.string(), errno);
    if (auto written = write_all(file, bytes); !written) return written;
    if (::fsync(file.get()) != 0) return file_error(path.string(), errno);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) return file_error(path.string(), errno);
  return sync_folder(path.parent_path());
}

api::Status sync_folder(const std::filesystem::path& folder) {
  const FileHandle handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!handle || ::fsync(handle.get()) != 0) return file_error(folder.string(), errno);
  return api::Done{};
}

api::Status sync_tree(const std::filesystem::path& folder) {
  std::error_code error;
  auto entry = std::filesystem::recursive_directory_iterator(folder, error);
  for (const auto end = std::filesystem::end(entry); !error && entry != end; entry.increment(error)) {
    const auto type = entry->symlink_status(error).type();
    if (error) break;
    if (type != std::filesystem::file_type::directory && type != std::filesystem::file_type::regular)
      continue;
    const FileHandle handle(::open(entry->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (!handle || ::fsync(handle.get()) != 0) return file_error(entry->path().string(), errno);
  }
  if (error) return file_error(folder.string(), error.value());
  return sync_folder(folder);
}

// Moved first, while nothing else of it is durable yet, and then made durable in one go: the journal of the
// file system has mostly one thing to write, not one for every file.
api::Status move_folder(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) return file_error("move to " + to.string(), errno);
  if (api::Status synced = sync_tree(to); !synced) return synced;
  if (api::Status synced = sync_folder(to.parent_path()); !synced) return synced;
  return sync_folder(from.parent_path());
}

}  // namespace server
