#include "server/copy_tree.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "api/fault_point.h"
#include "server/artefacts/files.h"

namespace server {
namespace {

namespace fs = std::filesystem;

api::Error copy_error(const fs::path& from, int error_number) {
  api::Error error = file_error(from.string(), error_number);
  if (error_number == ENOENT) error.fault = api::Fault::not_found;
  return error;
}

api::Status link_or_copy(const fs::path& from, const fs::path& to) {
  if (::link(from.c_str(), to.c_str()) == 0) return api::Done{};
  return copy_durably(from, to);
}

api::Status take_entry(const fs::directory_entry& entry, const fs::path& to, Taking taking) {
  std::error_code error;
  const fs::file_status status = entry.symlink_status(error);
  if (fs::is_directory(status)) return take_tree(entry.path(), to, taking);
  if (!fs::is_regular_file(status)) return api::Done{};
  const api::Status taken =
      taking == Taking::links ? link_or_copy(entry.path(), to) : copy_durably(entry.path(), to);
  // Between listing and taking somebody has removed it.
  if (!taken && taken.error().fault == api::Fault::not_found) return api::Done{};
  return taken;
}

/// The mark of a folder that is ours and not whole, locked for as long as somebody is at it.
api::Result<FileHandle> mark_half_made(const fs::path& part) {
  FileHandle mark(::open((part / kHalfMade).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!mark) return file_error((part / kHalfMade).string(), errno);
  if (::flock(mark.get(), LOCK_EX | LOCK_NB) != 0)
    return api::Error{api::Fault::wrong_state, part.string() + " is being made by another process"};
  return mark;
}

/// An empty folder `part`, marked.
api::Result<FileHandle> begin_part(const fs::path& part) {
  std::error_code error;
  fs::create_directories(part.parent_path(), error);
  if (::mkdir(part.c_str(), 0700) == 0) return mark_half_made(part);
  if (errno != EEXIST) return file_error(part.string(), errno);
  // An empty one is what a process leaves that is killed before it makes the mark.
  const bool folder = fs::is_directory(fs::symlink_status(part, error));
  if (!folder || !(fs::exists(part / kHalfMade, error) || fs::is_empty(part, error)))
    return api::Error{api::Fault::wrong_state,
                      part.string() + " exists already and is not half a copy of ours; move it away"};
  auto mark = mark_half_made(part);
  if (!mark) return mark;
  for (fs::directory_iterator at(part, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename() == kHalfMade) continue;
    if (at->is_directory(error) && !at->is_symlink(error)) {
      if (api::Status removed = remove_tree(at->path()); !removed) return removed.error();
    } else {
      fs::remove(at->path(), error);
    }
  }
  if (error) return file_error(part.string(), error.value());
  return mark;
}

}  // namespace

api::Status copy_durably(const fs::path& from, const fs::path& to) {
  FileHandle source(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!source) return copy_error(from, errno);
  FileHandle target(::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!target) return file_error(to.string(), errno);
  std::array<char, 64 * 1024> piece;
  for (;;) {
    const ssize_t count = ::read(source.get(), piece.data(), piece.size());
    if (count < 0) return file_error(from.string(), errno);
    if (count == 0) break;
    if (api::Status written = write_all(target, {piece.data(), static_cast<std::size_t>(count)}); !written)
      return written;
  }
  if (::fsync(target.get()) != 0) return file_error(to.string(), errno);
  return api::Done{};
}

api::Status take_tree(const fs::path& from, const fs::path& to, Taking taking) {
  return take_some(from, to, taking, [](const std::string&) { return true; });
}

api::Status take_some(const fs::path& from, const fs::path& to, Taking taking,
                      const std::function<bool(const std::string& name)>& wanted) {
  std::error_code error;
  fs::directory_iterator at(from, error);
  if (error == std::errc::no_such_file_or_directory) return api::Done{};
  if (error) return file_error(from.string(), error.value());
  fs::create_directories(to, error);
  if (error) return file_error(to.string(), error.value());
  for (const fs::directory_iterator end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(".tmp.") || !wanted(name)) continue;
    if (api::Status taken = take_entry(*at, to / name, taking); !taken) return taken;
  }
  if (error) return file_error(from.string(), error.value());
  return api::Done{};
}

api::Status appear_whole(const fs::path& to, const std::function<api::Status(const fs::path& part)>& make) {
  std::error_code error;
  if (fs::exists(to, error)) return api::Error{api::Fault::wrong_state, to.string() + " exists already"};
  const fs::path absolute = fs::absolute(to, error).lexically_normal();
  const fs::path part = absolute.string() + kPart;
  const auto mark = begin_part(part);
  if (!mark) return mark.error();
  api::Status made = make(part);
  if (made) made = sync_tree(part);
  api::fault_point("folder_made");
  if (made && ::rename(part.c_str(), absolute.c_str()) != 0) made = file_error(absolute.string(), errno);
  api::fault_point("folder_named");
  if (!made) {
    (void)remove_tree(part);
    return made;
  }
  fs::remove(absolute / kHalfMade, error);
  if (api::Status synced = sync_folder(absolute); !synced) return synced;
  return sync_folder(absolute.parent_path());
}

}  // namespace server
