// The worker's place among processes: it outlives nobody, yields to everybody, and stops when told.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>

#include "api/exit_code.h"
#include "api/result.h"

namespace engine {

/// For every run: no new privileges, no core files, umask 027, SIGPIPE ignored, memory that is freed goes
/// back to the system. Call from main, before threads.
void settle_in();

/// For a run under a supervisor: SIGKILL when the parent dies, no inherited descriptors but 0, 1 and 2,
/// nice 10, first in line for the out-of-memory killer. The kernel means the parent's *thread*: the one that
/// spawned us must live as long as we shall.
/// Errors: wrong_state when `parent` is not our parent, that is, it died already; stop then.
api::Status bind_to_parent(pid_t parent);

// Sanitizers map terabytes for themselves: under a limit on memory not even their first page is to be had.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kMemoryCanBeLimited = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
inline constexpr bool kMemoryCanBeLimited = false;
#else
inline constexpr bool kMemoryCanBeLimited = true;
#endif
#else
inline constexpr bool kMemoryCanBeLimited = true;
#endif

struct SelfLimits {
  /// Private writable memory (RLIMIT_DATA) beyond what the program holds already: that differs between
  /// systems and is not the job's doing. What the module of image codecs draws in later, for a job with
  /// textures, counts: about 100 MB.
  std::uint64_t memory_bytes = 0;
  std::uint64_t processor_seconds = 0;  ///< over all threads; SIGXCPU then, SIGKILL two seconds later
  std::uint64_t file_bytes = 0;         ///< per file written; beyond it writes fail with EFBIG
};

/// Without the limit on memory unless kMemoryCanBeLimited. Not the address space: thread pools and ray
/// tracers reserve far more of it than they use. Errors: internal. A limit that is already lower stays.
api::Status limit_myself(const SelfLimits& limits);

/// Who writes the report of this process: the thread that did the work, or the one that ends it in the midst
/// of it. Whoever asks first; the other writes nothing.
class LastWord {
 public:
  /// For the thread that listens. False: the other has it, and ends the process itself.
  bool take() { return !taken_.exchange(true); }
  /// For the thread that did the work. Does not return where the other has it, who ends the process.
  void take_or_end();

 private:
  std::atomic<bool> taken_ = false;
};

/// A thread that hears what the outside wants while the main thread computes.
///
/// SIGTERM and SIGINT: `stop_requested` turns true; unless the object is destroyed within `grace`, the
/// process ends with ExitCode::stopped. SIGXCPU: the process ends with ExitCode::limit_exceeded.
/// Standard input closed, where asked for: the process ends with ExitCode::stopped at once.
/// `last_words` is called, on this thread, before the process is ended by the first two. Where it answers
/// false the process is ending by itself: then this thread leaves it alone, and hears nothing more.
///
/// The signals stay blocked in the calling thread and those it starts later, also after destruction: it
/// stands for the rest of the process. A child process must unblock them.
class Watch {
 public:
  struct Options {
    bool end_with_stdin = false;
    std::chrono::milliseconds grace{900};
    std::function<bool(api::ExitCode)> last_words = [](api::ExitCode) { return true; };
  };

  /// Call before other threads are started. Errors: internal.
  static api::Result<std::unique_ptr<Watch>> start(Options options);
  Watch(const Watch&) = delete;
  ~Watch();

  bool stop_requested() const { return stop_requested_.load(std::memory_order_relaxed); }

 private:
  Watch(Options options, int signals, int farewell);
  void listen();
  bool hear_signal();  ///< false: nothing more is to be heard
  void hear_stdin();
  void end_process(api::ExitCode code);

  const Options options_;
  const int signals_;   ///< signalfd
  const int farewell_;  ///< eventfd, readable once the object is being destroyed
  std::atomic<bool> stop_requested_ = false;
  std::chrono::steady_clock::time_point deadline_{};  ///< counts once stop_requested_; listener thread only
  std::thread listener_;
};

}  // namespace engine
