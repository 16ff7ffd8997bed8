#include "server/workers/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <utility>

#include "server/workers/spawn.h"

namespace server {
namespace {

struct Pipe {
  FileHandle read;
  FileHandle write;
};

api::Result<Pipe> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return file_error("pipe", errno);
  return Pipe{FileHandle(ends[0]), FileHandle(ends[1])};
}

/// The children of all ChildProcess objects. Locked while one is started or reaped: what is not in the list
/// then is a stray.
struct Children {
  std::mutex mutex;
  std::vector<pid_t> living;
};

Children& children() {
  static Children all;
  return all;
}

FileHandle open_pid(pid_t pid) {
  return FileHandle(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
}

}  // namespace

api::Result<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                              const std::vector<std::string>& arguments,
                                              const ChildLimits& limits) {
  auto input = make_pipe();
  if (!input) return input.error();
  auto output = make_pipe();
  if (!output) return output.error();
  ChildProcess child;
  const int error = [&] {
    const std::lock_guard lock(children().mutex);
    adopt_strays();
    const Spawned spawned = spawn(program, arguments, {input->read.get(), output->write.get()});
    child.pid_ = spawned.pid;
    if (spawned.error == 0) children().living.push_back(child.pid_);
    return spawned.error;
  }();
  if (error != 0)
    return api::Error{error == ENOENT ? api::Fault::not_found : api::Fault::internal,
                      file_error("start " + program.string(), error).message};
  limit_child(child.pid_, limits);
  child.pid_descriptor_ = open_pid(child.pid_);
  if (!child.pid_descriptor_)
    return file_error("watch " + program.string(), errno);  // the destructor ends the child
  child.input_ = std::move(input->write);
  child.output_ = std::move(output->read);
  ::fcntl(child.output_.get(), F_SETFL, O_NONBLOCK);
  return child;
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      pid_descriptor_(std::move(other.pid_descriptor_)),
      input_(std::move(other.input_)),
      output_(std::move(other.output_)) {}

ChildProcess::~ChildProcess() {
  if (pid_ < 0) return;
  signal_group(SIGKILL);
  (void)reap();
}

void ChildProcess::signal_group(int signal) const {
  // Until it is reaped its pid, and so its group, can be nobody else's.
  if (pid_ > 0 && ::kill(-pid_, signal) != 0) ::kill(pid_, signal);
}

bool ChildProcess::has_ended() const {
  siginfo_t information{};
  return ::waitid(P_PID, static_cast<id_t>(pid_), &information, WEXITED | WNOWAIT | WNOHANG) == 0 &&
         information.si_pid == pid_;
}

ProcessEnd ChildProcess::reap() {
  siginfo_t information{};
  while (::waitid(P_PID, static_cast<id_t>(pid_), &information, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  const std::lock_guard lock(children().mutex);
  signal_group(SIGKILL);
  int status = 0;
  rusage used{};
  while (::wait4(pid_, &status, 0, &used) < 0 && errno == EINTR) {
  }
  const std::int64_t peak_bytes = std::int64_t{used.ru_maxrss} * 1024;
  std::erase(children().living, pid_);
  (void)kill_strays(children().living);
  pid_ = -1;
  if (WIFSIGNALED(status)) return {std::nullopt, WTERMSIG(status), peak_bytes};
  return {WEXITSTATUS(status), std::nullopt, peak_bytes};
}

std::string signal_name(int signal) {
  const char* name = ::sigabbrev_np(signal);
  return name ? "SIG" + std::string(name) : "signal " + std::to_string(signal);
}

}  // namespace server
