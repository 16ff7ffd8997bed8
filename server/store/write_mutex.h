// Held by who writes, for as long as the disk takes.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>

namespace server {

/// A mutex that others can ask for how long it has been held.
class WriteMutex {
 public:
  using Clock = std::chrono::steady_clock;

  void lock() {
    mutex_.lock();
    since_ = Clock::now().time_since_epoch().count();
  }
  bool try_lock() {
    if (!mutex_.try_lock()) return false;
    since_ = Clock::now().time_since_epoch().count();
    return true;
  }
  void unlock() {
    since_ = kFree;
    mutex_.unlock();
  }

  /// Zero: nobody holds it.
  Clock::duration held_for() const {
    const Clock::rep since = since_;
    return since == kFree ? Clock::duration(0) : Clock::now().time_since_epoch() - Clock::duration(since);
  }

 private:
  static constexpr Clock::rep kFree = -1;
  std::mutex mutex_;
  std::atomic<Clock::rep> since_ = kFree;
};

}  // namespace server
