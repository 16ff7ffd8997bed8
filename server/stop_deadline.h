// Stopping ends in time, whatever hangs.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace server {

/// Ends the process with `exit_code` unless it is destroyed within `patience`: whatever is under way, the
/// data folder survives it.
class StopDeadline {
 public:
  StopDeadline(std::chrono::milliseconds patience, int exit_code);
  ~StopDeadline();
  StopDeadline(const StopDeadline&) = delete;
  StopDeadline& operator=(const StopDeadline&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable done_;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace server
