#include "server/workers/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <utility>

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

/// What posix_spawn is told, freed with its owner.
class SpawnPlan {
 public:
  SpawnPlan(int input, int output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigset_t all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnPlan() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&actions_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

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
  std::string name = program.string();
  std::vector<std::string> words = arguments;
  std::vector<char*> argv{name.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const SpawnPlan plan(input->read.get(), output->write.get());
  ChildProcess child;
  const int error = [&] {
    const std::lock_guard lock(children().mutex);
    adopt_strays();
    const int failed =
        ::posix_spawn(&child.pid_, name.c_str(), plan.actions(), plan.attributes(), argv.data(), environ);
    if (failed == 0) children().living.push_back(child.pid_);
    return failed;
  }();
  if (error != 0) {
    child.pid_ = -1;
    return api::Error{error == ENOENT ? api::Fault::not_found : api::Fault::internal,
                      file_error("start " + name, error).message};
  }
  limit_child(child.pid_, limits);
  child.pid_descriptor_ = open_pid(child.pid_);
  if (!child.pid_descriptor_) return file_error("watch " + name, errno);  // the destructor ends the child
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
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  std::erase(children().living, pid_);
  (void)kill_strays(children().living);
  pid_ = -1;
  if (WIFSIGNALED(status)) return {std::nullopt, WTERMSIG(status)};
  return {WEXITSTATUS(status), std::nullopt};
}

std::string signal_name(int signal) {
  const char* name = ::sigabbrev_np(signal);
  return name ? "SIG" + std::string(name) : "signal " + std::to_string(signal);
}

}  // namespace server
