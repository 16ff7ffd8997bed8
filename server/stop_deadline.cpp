#include "server/stop_deadline.h"

#include <unistd.h>

namespace server {

StopDeadline::StopDeadline(std::chrono::milliseconds patience, int exit_code)
    : thread_([this, patience, exit_code] {
        std::unique_lock lock(mutex_);
        if (!done_.wait_for(lock, patience, [this] { return stopped_; })) ::_exit(exit_code);
      }) {}

StopDeadline::~StopDeadline() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  done_.notify_one();
  thread_.join();
}

}  // namespace server
