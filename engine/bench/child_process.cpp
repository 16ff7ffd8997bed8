#include "engine/bench/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

extern char** environ;

namespace engine {
namespace {

std::string last_line(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line, last;
  while (std::getline(file, line))
    if (!line.empty()) last = line;
  return last;
}

/// What the child's standard streams are; freed with it.
class Streams {
 public:
  explicit Streams(const std::filesystem::path& log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0640);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  Streams(const Streams&) = delete;
  ~Streams() { posix_spawn_file_actions_destroy(&actions_); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

api::Error failure(const std::string& program, const std::string& why) {
  return {api::Fault::internal, program + " " + why};
}

/// Its status and what it used; false where it is lost. `seconds` > 0: it is stopped then, `late` says so.
bool wait_for(pid_t child, double seconds, int& status, rusage& use, bool& late) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    const bool poll = seconds > 0 && !late;
    const pid_t ended = wait4(child, &status, poll ? WNOHANG : 0, &use);
    if (ended == child) return true;
    if (ended < 0 && errno != EINTR) return false;
    if (!poll) continue;
    if (Clock::now() > end) {
      late = true;
      kill(child, SIGTERM);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

double seconds_in(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

api::Result<ChildUse> run_child(const std::vector<std::string>& words, const std::filesystem::path& log,
                                const ChildLimits& limits) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const Streams streams(log);
  pid_t child = 0;
  if (const int fault = posix_spawn(&child, arguments[0], streams.get(), nullptr, arguments.data(), environ))
    return failure(words[0], std::string("cannot be started: ") + std::strerror(fault));
  const rlimit memory{limits.memory_bytes, limits.memory_bytes};
  if (limits.memory_bytes > 0) prlimit(child, RLIMIT_DATA, &memory, nullptr);
  int status = 0;
  rusage use{};
  bool late = false;
  if (!wait_for(child, limits.seconds, status, use, late))
    return failure(words[0], std::string("is lost: ") + std::strerror(errno));
  if (late)
    return api::Error{api::Fault::out_of_resources,
                      "stopped after " + std::to_string(static_cast<int>(limits.seconds)) + " s"};
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    constexpr std::uint64_t kKilobyte = 1024;  // the unit of ru_maxrss
    return ChildUse{seconds_in(use.ru_utime) + seconds_in(use.ru_stime),
                    kKilobyte * static_cast<std::uint64_t>(use.ru_maxrss)};
  }
  const std::string how = WIFSIGNALED(status) ? "was ended by signal " + std::to_string(WTERMSIG(status))
                                              : "ended with status " + std::to_string(WEXITSTATUS(status));
  return failure(words[0], how + ": " + last_line(log));
}

}  // namespace engine
