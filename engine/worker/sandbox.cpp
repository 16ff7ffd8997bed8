#include "engine/worker/sandbox.h"

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

#include "engine/worker/landlock.h"
#include "engine/worker/system_calls.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t kOpenFilesMax = 1024;
constexpr rlim_t kFileBytesMax = rlim_t{1} << 38;  // radiosity of ten thousand frames, with room
// Of the user, not of the process: far above what a desktop has, and still an end to a fork bomb where the
// kernel has no filters.
constexpr rlim_t kTasksMax = 8192;

/// Libraries, what they ask about the machine, and the program with its module of image codecs.
FileRules rules_for(const fs::path& job_folder, const fs::path& writable) {
  FileRules rules;
  rules.read = {"/usr",         "/lib",          "/lib64",        "/etc/ld.so.cache",
                "/proc/self",   "/proc/cpuinfo", "/proc/meminfo", "/sys/devices/system",
                "/dev/urandom", "/dev/zero"};
  std::error_code none;
  const fs::path program_folder = fs::read_symlink("/proc/self/exe", none).parent_path();
  rules.read.push_back(program_folder);
  rules.read.push_back(program_folder.parent_path() / "lib/keylume");
  const char* variable = std::getenv("LD_LIBRARY_PATH");
  for (std::string_view folders = variable ? variable : ""; !folders.empty();) {
    const std::size_t colon = folders.find(':');
    if (colon != 0) rules.read.emplace_back(folders.substr(0, colon));
    folders = colon == folders.npos ? std::string_view() : folders.substr(colon + 1);
  }
  rules.read.push_back(job_folder);
  rules.write = {writable, "/dev/null"};
  return rules;
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
  return lower(RLIMIT_CORE, 0) && lower(RLIMIT_NOFILE, kOpenFilesMax) && lower(RLIMIT_FSIZE, kFileBytesMax) &&
         lower(RLIMIT_NPROC, kTasksMax);
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

}  // namespace

api::Result<std::string> enter_sandbox(const fs::path& job_folder, const fs::path& write_only_in) {
  const auto landlock =
      restrict_files(rules_for(job_folder, write_only_in.empty() ? job_folder : write_only_in));
  if (!landlock) return landlock.error();
  if (!set_limits() || !drop_capabilities())
    return api::Error{api::Fault::internal, "sandbox: limits: " + std::generic_category().message(errno)};
  const auto filtered = refuse_system_calls();
  if (!filtered) return filtered.error();
  std::string in_force;
  if (*landlock > 0) in_force += "landlock " + std::to_string(*landlock) + ", ";
  if (*filtered) in_force += "seccomp, ";
  return in_force + "limits";
}

}  // namespace engine
