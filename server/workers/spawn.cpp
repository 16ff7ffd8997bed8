#include "server/workers/spawn.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "server/artefacts/files.h"

namespace server {
namespace {

/// What the child needs, made before it begins: between vfork and exec it may not allocate.
struct Plan {
  const char* program;
  char* const* words;
  ChildPipes pipes;
  int report;  ///< write end of the pipe that takes errno
  pid_t parent;
};

/// Every signal as it is by default: what the server ignores, SIGPIPE, its children would ignore too.
void default_signals() {
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (int number = 1; number < NSIG; ++number) ::sigaction(number, &usual, nullptr);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// In the child, which shares our memory until exec: system calls only.
bool become(const Plan& plan) {
  if (::setsid() < 0) return false;
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return false;
  // A parent that died before that line sends no signal any more.
  if (::getppid() != plan.parent) return false;
  if (::dup2(plan.pipes.input, STDIN_FILENO) < 0 || ::dup2(plan.pipes.output, STDOUT_FILENO) < 0 ||
      ::dup2(plan.pipes.output, STDERR_FILENO) < 0)
    return false;
  // Closed by exec, so that `report` lives until then.
  (void)::close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);
  default_signals();
  ::execv(plan.program, plan.words);
  return false;
}

[[noreturn]] void be_the_child(const Plan& plan) {
  (void)become(plan);
  const int error = errno;
  (void)!::write(plan.report, &error, sizeof error);
  ::_exit(127);
}

/// With all signals blocked, for the child shares our memory, not our idea of what a handler may do to it.
pid_t begin(const Plan& plan) {
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  // Not fork: of a server with much memory that takes milliseconds, and then a fault for every page.
  const pid_t pid = ::vfork();
  if (pid == 0) be_the_child(plan);
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return pid;
}

}  // namespace

Spawned spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments,
              const ChildPipes& pipes) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {-1, errno};
  const FileHandle told(ends[0]);
  FileHandle report(ends[1]);
  std::string name = program.string();
  std::vector<std::string> words = arguments;
  std::vector<char*> argv{name.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t pid = begin({name.c_str(), argv.data(), pipes, report.get(), ::getpid()});
  if (pid < 0) return {-1, errno};
  report.close();
  int error = 0;
  ssize_t count = 0;
  while ((count = ::read(told.get(), &error, sizeof error)) < 0 && errno == EINTR) {
  }
  if (count == 0) return {pid, 0};
  while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
  return {-1, error == 0 ? ESRCH : error};
}

}  // namespace server
