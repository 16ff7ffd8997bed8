#include "engine/worker/supervision.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string>
#include <system_error>
#include <utility>

#include "engine/worker/proc_status.h"

namespace engine {
namespace {

using Resource = decltype(RLIMIT_CPU);  // an enum with glibc, an int elsewhere

constexpr int kNice = 10;

api::Error system_failure(const char* what) {
  return {api::Fault::internal, std::string(what) + ": " + std::generic_category().message(errno)};
}

/// Never above what is allowed now: an unprivileged process could not, and should not.
bool lower_limit(Resource resource, rlim_t soft, rlim_t hard) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return false;
  limit.rlim_max = std::min(limit.rlim_max, hard);
  limit.rlim_cur = std::min(soft, limit.rlim_max);
  return setrlimit(resource, &limit) == 0;
}

void volunteer_for_oom_killer() {
  const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;  // no /proc: the kernel's own score will do
  [[maybe_unused]] const ssize_t written = write(file, "500", 3);
  close(file);
}

/// Left alone, glibc takes what is freed as a hint of what is to come, keeps up to 64 MiB of it, and a run
/// holds a tenth to a fifth more than it needs. Pages that come anew cost it less than can be measured.
void give_back_what_is_freed() {
#ifdef M_MMAP_THRESHOLD
  (void)mallopt(M_MMAP_THRESHOLD, 128 << 10);
  (void)mallopt(M_TRIM_THRESHOLD, 1 << 20);
#endif
}

}  // namespace

void settle_in() {
  give_back_what_is_freed();
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  lower_limit(RLIMIT_CORE, 0, 0);
  umask(027);
  signal(SIGPIPE, SIG_IGN);
}

api::Status bind_to_parent(pid_t parent) {
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return system_failure("cannot bind to the parent process");
  // A parent that died before the line above sends no signal any more.
  if (getppid() != parent)
    return api::Error{api::Fault::wrong_state,
                      "process " + std::to_string(parent) + " is not the parent of this one, or has ended"};
  close_range(STDERR_FILENO + 1, ~0u, 0);
  setpriority(PRIO_PROCESS, 0, std::max(kNice, getpriority(PRIO_PROCESS, 0)));
  volunteer_for_oom_killer();
  return api::Done{};
}

api::Status limit_myself(const SelfLimits& limits) {
  signal(SIGXFSZ, SIG_IGN);
  const rlim_t memory_bytes = limits.memory_bytes + memory_bytes_of_self("VmData:").value_or(0);
  if ((kMemoryCanBeLimited && !lower_limit(RLIMIT_DATA, memory_bytes, memory_bytes)) ||
      !lower_limit(RLIMIT_CPU, limits.processor_seconds, limits.processor_seconds + 2) ||
      !lower_limit(RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes))
    return system_failure("cannot limit this process");
  return api::Done{};
}

void LastWord::take_or_end() {
  if (take()) return;
  for (;;) pause();
}

api::Result<std::unique_ptr<Watch>> Watch::start(Options options) {
  sigset_t heard;
  sigemptyset(&heard);
  for (const int number : {SIGTERM, SIGINT, SIGXCPU}) sigaddset(&heard, number);
  if (pthread_sigmask(SIG_BLOCK, &heard, nullptr) != 0) return system_failure("cannot block signals");
  const int signals = signalfd(-1, &heard, SFD_CLOEXEC | SFD_NONBLOCK);
  if (signals < 0) return system_failure("cannot listen for signals");
  const int farewell = eventfd(0, EFD_CLOEXEC);
  if (farewell < 0) {
    close(signals);
    return system_failure("cannot create an event");
  }
  return std::unique_ptr<Watch>(new Watch(std::move(options), signals, farewell));
}

Watch::Watch(Options options, int signals, int farewell)
    : options_(std::move(options)), signals_(signals), farewell_(farewell), listener_([this] { listen(); }) {}

Watch::~Watch() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(farewell_, &one, sizeof one);
  listener_.join();
  close(farewell_);
  close(signals_);
}

void Watch::listen() {
  using namespace std::chrono;
  std::array<pollfd, 3> sources{pollfd{farewell_, POLLIN, 0}, pollfd{signals_, POLLIN, 0},
                                pollfd{options_.end_with_stdin ? STDIN_FILENO : -1, POLLIN, 0}};
  for (;;) {
    int timeout_ms = -1;
    if (stop_requested()) {
      const auto left = ceil<milliseconds>(deadline_ - steady_clock::now());
      if (left <= milliseconds::zero()) return end_process(api::ExitCode::stopped);
      timeout_ms = static_cast<int>(left.count());
    }
    if (poll(sources.data(), sources.size(), timeout_ms) < 0) continue;  // EINTR
    if (sources[0].revents != 0) return;
    if (sources[1].revents != 0 && !hear_signal()) return;
    if (sources[2].revents != 0) hear_stdin();
  }
}

bool Watch::hear_signal() {
  signalfd_siginfo about{};
  if (read(signals_, &about, sizeof about) != sizeof about) return true;
  if (about.ssi_signo == SIGXCPU) {
    end_process(api::ExitCode::limit_exceeded);
    return false;
  }
  if (stop_requested()) return true;  // the deadline is that of the first signal
  deadline_ = std::chrono::steady_clock::now() + options_.grace;
  stop_requested_.store(true, std::memory_order_relaxed);
  return true;
}

void Watch::hear_stdin() {
  std::array<char, 256> ignored;
  const ssize_t got = read(STDIN_FILENO, ignored.data(), ignored.size());
  // Nobody is left who would read last words; a closed descriptor (EBADF) counts as an ended one.
  if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN))
    _exit(static_cast<int>(api::ExitCode::stopped));
}

void Watch::end_process(api::ExitCode code) {
  try {
    if (!options_.last_words(code)) return;
  } catch (...) {
    // The end matters more.
  }
  _exit(static_cast<int>(code));
}

}  // namespace engine
