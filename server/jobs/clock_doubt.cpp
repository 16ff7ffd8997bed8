#include "server/jobs/clock_doubt.h"

#include <time.h>

#include <string>
#include <utility>

#include "server/log.h"

namespace server {

std::int64_t boot_clock_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

ClockDoubt::ClockDoubt(Clock wall, Clock steady)
    : wall_(std::move(wall)), steady_(std::move(steady)), believed_ms_(wall_() - steady_()) {}

bool ClockDoubt::is_doubtful() {
  const std::lock_guard lock(mutex_);
  const std::int64_t steady_ms = steady_();
  const std::int64_t ahead_ms = wall_() - steady_ms;
  const std::int64_t jump_ms = ahead_ms - believed_ms_;
  if (jump_ms > kJumpMsMin && !doubted_since_ms_) {
    doubted_since_ms_ = steady_ms;
    log_line(
        "the clock jumped forward by " + std::to_string(jump_ms / 1000) +
        " s: nothing is removed or given up because its time is over, for a day or until the clock is back");
  }
  const bool doubted = jump_ms > kJumpMsMin && steady_ms - *doubted_since_ms_ < kDoubtMs;
  if (doubted) return true;
  if (doubted_since_ms_) log_line("the clock is believed again");
  doubted_since_ms_.reset();
  believed_ms_ = ahead_ms;  // clocks drift
  return false;
}

}  // namespace server
