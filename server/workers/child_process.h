// One child process in a session of its own, and the pipes to it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "api/result.h"
#include "server/artefacts/files.h"
#include "server/store/job_rows.h"
#include "server/workers/sandbox.h"

namespace server {

/// How a process ended: exactly one of the first two.
struct ProcessEnd {
  std::optional<int> exit_code;
  std::optional<int> signal;
  std::int64_t peak_bytes = 0;  ///< largest resident set; no less than this process had when it started it
};

/// Leader of its own session and process group, with default signal handling and no descriptors of ours but:
/// standard input, a pipe that ends when we do, so that the child learns of our death; standard output and
/// standard error, one pipe to `output`. Killed and reaped with its owner, and so is what it left behind,
/// wherever that hid.
///
/// The kernel kills it with the thread that started it: that thread must live as long as the child.
class ChildProcess {
 public:
  /// Errors: not_found or internal when the program cannot be started.
  static api::Result<ChildProcess> start(const std::filesystem::path& program,
                                         const std::vector<std::string>& arguments,
                                         const ChildLimits& limits = {});
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  pid_t pid() const { return pid_; }
  /// Readable (poll) once the process has ended.
  int ended_descriptor() const { return pid_descriptor_.get(); }
  /// Read end of its output, not blocking.
  const FileHandle& output() const { return output_; }

  /// Sends `signal` to every process of its group.
  void signal_group(int signal) const;
  bool has_ended() const;
  /// Waits for its end, kills what it left behind in its group, and reaps it.
  ProcessEnd reap();

 private:
  ChildProcess() = default;

  pid_t pid_ = -1;  ///< -1 once reaped
  FileHandle pid_descriptor_;
  FileHandle input_;
  FileHandle output_;
};

/// Of a living process. Errors: not_found when there is none.
api::Result<ProcessIdentity> identity_of(pid_t pid);

/// If `process` still lives (same pid, start time and boot), kills its group and waits until it is gone.
/// Errors: internal when it does not die.
api::Status kill_and_confirm(const ProcessIdentity& process);

/// "SIGSEGV" for 11.
std::string signal_name(int signal);

}  // namespace server
