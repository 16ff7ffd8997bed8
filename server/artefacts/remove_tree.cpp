// Deletes folders that a stranger's program has filled: nested deeper than there are descriptors or room in a
// path, with modes that let nobody in. Folders within folders are moved to the top first, so that two
// descriptors are enough, whatever the depth.
#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <string>
#include <vector>

#include "server/artefacts/files.h"

namespace server {
namespace {

constexpr std::size_t kNamesAtOnce = 1024;
constexpr mode_t kOpenToUs = 0700;

using Folder = std::unique_ptr<DIR, int (*)(DIR*)>;

Folder open_folder(int parent, const char* name) {
  // Links have been unlinked by now, so this is about the folder itself.
  (void)::fchmodat(parent, name, kOpenToUs, 0);
  const int descriptor = ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  Folder folder(descriptor < 0 ? nullptr : ::fdopendir(descriptor), ::closedir);
  if (!folder && descriptor >= 0) ::close(descriptor);
  return folder;
}

/// Some of its entries; none: there are no more.
std::vector<std::string> some_names(DIR* folder) {
  std::vector<std::string> names;
  ::rewinddir(folder);
  while (const dirent* entry = names.size() < kNamesAtOnce ? ::readdir(folder) : nullptr)
    if (const std::string_view name = entry->d_name; name != "." && name != "..") names.emplace_back(name);
  return names;
}

bool is_folder_error(int error) {
  return error == EISDIR || error == EPERM;
}

/// Files are deleted, folders that are not empty go to `top`.
bool empty(DIR* folder, int top, std::uint64_t& number) {
  const int at = ::dirfd(folder);
  for (auto names = some_names(folder); !names.empty(); names = some_names(folder)) {
    for (const std::string& name : names) {
      if (::unlinkat(at, name.c_str(), 0) == 0) continue;
      if (!is_folder_error(errno)) return false;
      if (::unlinkat(at, name.c_str(), AT_REMOVEDIR) == 0) continue;
      (void)::fchmodat(at, name.c_str(), kOpenToUs, 0);
      while (::renameat(at, name.c_str(), top, (".gone." + std::to_string(number++)).c_str()) != 0)
        if (errno != EEXIST && errno != ENOTEMPTY && errno != EISDIR && errno != ENOTDIR) return false;
    }
  }
  return true;
}

bool empty_top(DIR* folder) {
  const int top = ::dirfd(folder);
  std::uint64_t number = 0;
  for (auto names = some_names(folder); !names.empty(); names = some_names(folder)) {
    for (const std::string& name : names) {
      if (::unlinkat(top, name.c_str(), 0) == 0) continue;
      if (!is_folder_error(errno)) return false;
      const Folder below = open_folder(top, name.c_str());
      if (!below || !empty(below.get(), top, number)) return false;
      if (::unlinkat(top, name.c_str(), AT_REMOVEDIR) != 0) return false;
    }
  }
  return true;
}

}  // namespace

api::Status remove_tree(const std::filesystem::path& folder) {
  const auto failed = [&] { return file_error("remove " + folder.string(), errno); };
  if (::unlink(folder.c_str()) == 0 || errno == ENOENT || errno == ENOTDIR) return api::Done{};
  if (!is_folder_error(errno)) return failed();
  if (::rmdir(folder.c_str()) == 0) return api::Done{};
  const Folder top = open_folder(AT_FDCWD, folder.c_str());
  if (!top || !empty_top(top.get()) || ::rmdir(folder.c_str()) != 0) return failed();
  return api::Done{};
}

}  // namespace server
