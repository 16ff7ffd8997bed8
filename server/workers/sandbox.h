// What holds a worker, beside what it does to itself (keylume --sandbox): limits set from outside, and an end
// to what it leaves behind. A worker whose scene has taken it over obeys nothing else.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>

namespace server {

/// What the kernel offers to `keylume --sandbox`, for /version.
struct WorkerSandbox {
  int landlock = 0;      ///< version of Landlock; 0: workers reach whatever files the server does
  bool seccomp = false;  ///< workers open no sockets and start no processes
};
WorkerSandbox worker_sandbox();
/// "landlock 7, seccomp, limits", as in a worker's report.
std::string text_of(const WorkerSandbox& sandbox);

struct ChildLimits {
  std::uint64_t memory_bytes = 0;                     ///< private writable memory; 0: no limit
  std::uint64_t file_bytes = std::uint64_t{1} << 38;  ///< of each file it writes
  std::uint64_t open_files = 1024;
};

/// Limits a child that has just been started, and volunteers it for the out-of-memory killer. What the kernel
/// refuses is left out.
void limit_child(pid_t child, const ChildLimits& limits);

/// From now on processes whose parent has died become children of this one, whatever sessions and groups they
/// hid in, and kill_strays finds them.
void adopt_strays();

/// Kills and reaps the children of this process that it did not start: those in another session than its own
/// and not among `known`. They may beget others meanwhile: it is tried for up to
/// 2 s, which is not enough for a chain of processes that each live for less than it takes to look for them.
/// -> how many there were
int kill_strays(std::span<const pid_t> known);

}  // namespace server
