#include "server/workers/sandbox.h"

#include <dirent.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "server/artefacts/files.h"

namespace server {
namespace {

constexpr long kCreateRuleset = 444;  // the same number on every architecture
constexpr std::chrono::seconds kStraysMax{2};
constexpr std::chrono::milliseconds kLookAgainAfter{1};

void lower(pid_t child, decltype(RLIMIT_CPU) resource, rlim_t most) {
  rlimit limit{};
  if (::prlimit(child, resource, nullptr, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  (void)::prlimit(child, resource, &limit, nullptr);
}

struct Kinship {
  pid_t parent = 0;
  pid_t session = 0;
};

/// From /proc/PID/stat: "pid (name) state parent group session ..."; the name may hold anything.
std::optional<Kinship> kinship_of(pid_t pid) {
  const FileHandle file(::open(("/proc/" + std::to_string(pid) + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
  if (!file) return std::nullopt;
  std::array<char, 512> bytes;
  const ssize_t count = ::read(file.get(), bytes.data(), bytes.size() - 1);
  if (count <= 0) return std::nullopt;
  bytes[static_cast<std::size_t>(count)] = '\0';
  const std::size_t name_end = std::string_view(bytes.data()).rfind(')');
  if (name_end == std::string_view::npos) return std::nullopt;
  Kinship kinship;
  pid_t group = 0;
  char state = 0;
  if (std::sscanf(bytes.data() + name_end + 1, " %c %d %d %d", &state, &kinship.parent, &group,
                  &kinship.session) != 4)
    return std::nullopt;
  return kinship;
}

std::vector<pid_t> all_processes() {
  std::vector<pid_t> all;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::opendir("/proc"), ::closedir);
  while (const dirent* entry = folder ? ::readdir(folder.get()) : nullptr)
    if (const auto pid = static_cast<pid_t>(std::atoi(entry->d_name)); pid > 0) all.push_back(pid);
  return all;
}

std::vector<pid_t> strays(std::vector<pid_t> among, std::span<const pid_t> known) {
  const pid_t self = ::getpid();
  const pid_t session = ::getsid(0);
  std::erase_if(among, [&](pid_t pid) {
    if (std::find(known.begin(), known.end(), pid) != known.end()) return true;
    const auto kinship = kinship_of(pid);
    return !kinship || kinship->parent != self || kinship->session == session;
  });
  return among;
}

}  // namespace

WorkerSandbox worker_sandbox() {
  WorkerSandbox sandbox;
  const long version = ::syscall(kCreateRuleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  sandbox.landlock = static_cast<int>(std::max(version, 0L));
#if defined(__x86_64__) || defined(__aarch64__)
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  sandbox.seccomp = ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
#endif
  return sandbox;
}

std::string text_of(const WorkerSandbox& sandbox) {
  std::string text;
  if (sandbox.landlock > 0) text += "landlock " + std::to_string(sandbox.landlock) + ", ";
  if (sandbox.seccomp) text += "seccomp, ";
  return text + "limits";
}

void limit_child(pid_t child, const ChildLimits& limits) {
  lower(child, RLIMIT_CORE, 0);
  lower(child, RLIMIT_FSIZE, limits.file_bytes);
  lower(child, RLIMIT_NOFILE, limits.open_files);
  if (limits.memory_bytes > 0) lower(child, RLIMIT_DATA, limits.memory_bytes);
  const std::string path = "/proc/" + std::to_string(child) + "/oom_score_adj";
  const FileHandle score(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (score) (void)!::write(score.get(), "500", 3);
}

void adopt_strays() {
  (void)::prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
}

int kill_strays(std::span<const pid_t> known) {
  int killed = 0;
  const auto give_up = std::chrono::steady_clock::now() + kStraysMax;
  while (std::chrono::steady_clock::now() < give_up) {
    const std::vector<pid_t> found = strays(all_processes(), known);
    if (found.empty()) break;
    for (const pid_t pid : found) (void)::kill(pid, SIGKILL);
    // One that does not die (a disk that does not answer) must not hold up whoever starts the next child.
    for (const pid_t pid : found)
      while (::waitpid(pid, nullptr, WNOHANG) == 0 && std::chrono::steady_clock::now() < give_up)
        std::this_thread::sleep_for(kLookAgainAfter);
    killed += static_cast<int>(found.size());
  }
  return killed;
}

}  // namespace server
