#include "server/jobs/folder_size.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>
#include <string_view>

namespace server {
namespace {

constexpr std::int64_t kBlockBytes = 512;  // of st_blocks, whatever the file system's are

class Measuring {
 public:
  explicit Measuring(const FolderBounds& bounds) : bounds_(bounds) {}

  void look_into(int parent, const char* name, int depth) {
    const int descriptor = ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0) return;
    const std::unique_ptr<DIR, int (*)(DIR*)> folder(::fdopendir(descriptor), ::closedir);
    if (!folder) {
      ::close(descriptor);
      return;
    }
    while (const dirent* entry = size_.beyond ? nullptr : ::readdir(folder.get()))
      if (const std::string_view found = entry->d_name; found != "." && found != "..")
        count(descriptor, entry->d_name, depth);
  }
  const FolderSize& size() const { return size_; }

 private:
  void count(int folder, const char* name, int depth) {
    struct stat about {};
    if (::fstatat(folder, name, &about, AT_SYMLINK_NOFOLLOW) != 0) return;
    size_.on_disk_bytes += std::int64_t{about.st_blocks} * kBlockBytes;
    if (++entries_ > bounds_.files) size_.beyond = true;
    if (S_ISREG(about.st_mode)) {
      size_.bytes += std::int64_t{about.st_size};
      ++size_.files;
    }
    if (!S_ISDIR(about.st_mode)) return;
    if (depth >= bounds_.depth)
      size_.beyond = true;
    else
      look_into(folder, name, depth + 1);
  }

  const FolderBounds bounds_;
  std::int64_t entries_ = 0;
  FolderSize size_;
};

}  // namespace

FolderSize size_of_folder(const std::filesystem::path& folder, const FolderBounds& bounds) {
  Measuring measuring(bounds);
  measuring.look_into(AT_FDCWD, folder.c_str(), 0);
  return measuring.size();
}

}  // namespace server
