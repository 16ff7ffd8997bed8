#include "engine/worker/sandbox.h"

#include <link.h>
#include <linux/capability.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/worker/landlock.h"
#include "engine/worker/system_calls.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t kOpenFilesMax = 1024;
constexpr rlim_t kAnyFileBytesMax = rlim_t{1} << 38;  // radiosity of ten thousand frames, with room
// Of the user, not of the process: far above what a desktop has, and still an end to a fork bomb where the
// kernel has no filters.
constexpr rlim_t kTasksMax = 8192;

/// `own`, libraries, and what they ask about the machine.
FileRules with_libraries(FileRules own) {
  FileRules rules = std::move(own);
  for (const char* path : {"/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/proc/self", "/proc/cpuinfo",
                           "/proc/meminfo", "/sys/devices/system", "/dev/urandom", "/dev/zero"})
    rules.read.emplace_back(path);
  rules.write.emplace_back("/dev/null");
  const char* variable = std::getenv("LD_LIBRARY_PATH");
  for (std::string_view folders = variable ? variable : ""; !folders.empty();) {
    const std::size_t colon = folders.find(':');
    if (colon != 0) rules.read.emplace_back(folders.substr(0, colon));
    folders = colon == folders.npos ? std::string_view() : folders.substr(colon + 1);
  }
  return rules;
}

/// The program with its module of image codecs.
void add_ourselves(FileRules& rules) {
  std::error_code none;
  const fs::path folder = fs::read_symlink("/proc/self/exe", none).parent_path();
  rules.read.push_back(folder);
  rules.read.push_back(folder.parent_path() / "lib/keylume");
}

/// What the kernel runs to load this program's libraries, and so those of any other of this system. Empty:
/// there are none.
fs::path loader() {
  std::string path;
  (void)dl_iterate_phdr(
      [](dl_phdr_info* program, std::size_t, void* into) {
        for (int i = 0; i < program->dlpi_phnum; ++i)
          if (const auto& part = program->dlpi_phdr[i]; part.p_type == PT_INTERP)
            *static_cast<std::string*>(into) =
                reinterpret_cast<const char*>(program->dlpi_addr + part.p_vaddr);
        return 1;  // the first is the program itself
      },
      &path);
  return path;
}

/// Never above what is allowed now.
bool lower(decltype(RLIMIT_CPU) resource, rlim_t most) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return false;
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  return setrlimit(resource, &limit) == 0;
}

bool set_limits() {
  signal(SIGXFSZ, SIG_IGN);  // the write fails with EFBIG instead
  return lower(RLIMIT_CORE, 0) && lower(RLIMIT_NOFILE, kOpenFilesMax) &&
         lower(RLIMIT_FSIZE, kAnyFileBytesMax) && lower(RLIMIT_NPROC, kTasksMax);
}

/// A worker of root's keeps what lets it reach its job folder below somebody's closed home; which files it
/// opens is Landlock's business.
bool drop_capabilities() {
  constexpr std::uint32_t kKept = 1u << CAP_DAC_OVERRIDE | 1u << CAP_DAC_READ_SEARCH;
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
  if (syscall(SYS_capget, &header, sets.data()) != 0) return false;
  sets[0] = {sets[0].effective & kKept, sets[0].permitted & kKept, 0};
  sets[1] = {};
  return syscall(SYS_capset, &header, sets.data()) == 0;
}

/// `but_run`: as of refuse_system_calls.
api::Result<std::string> shut_in(const FileRules& rules, const char* but_run) {
  const auto landlock = restrict_files(rules);
  if (!landlock) return landlock.error();
  if (!set_limits() || !drop_capabilities())
    return api::Error{api::Fault::internal, "sandbox: limits: " + std::generic_category().message(errno)};
  const auto filtered = refuse_system_calls(but_run);
  if (!filtered) return filtered.error();
  std::string in_force;
  if (*landlock > 0) in_force += "landlock " + std::to_string(*landlock) + ", ";
  if (*filtered) in_force += "seccomp, ";
  return in_force + "limits";
}

}  // namespace

api::Result<std::string> enter_sandbox(const FileRules& files) {
  FileRules rules = with_libraries(files);
  add_ourselves(rules);
  return shut_in(rules, nullptr);
}

api::Result<std::string> enter_sandbox_of(const fs::path& program, const FileRules& files) {
  FileRules rules = with_libraries(files);
  rules.run.push_back(program);
  if (const fs::path loads = loader(); !loads.empty()) rules.run.push_back(loads);
  rules.read.push_back(program.parent_path().parent_path() / "lib");  // of one that is not the system's
  return shut_in(rules, program.c_str());
}

}  // namespace engine
