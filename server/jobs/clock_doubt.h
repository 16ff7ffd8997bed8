// Is the wall clock to be believed? What is deleted because its time is over does not come back.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "server/store/job_store.h"

namespace server {

/// Milliseconds since the machine started, asleep or awake; nobody can set it.
std::int64_t boot_clock_ms();

/// A clock that jumps forward by more than an hour, against one that nobody can set, is doubted for a day, or
/// until it is back: somebody has typed a wrong year, or a battery is empty. One that jumps back makes things
/// stay longer, which is no harm. At the start it is believed: how long the server was down is not known.
/// Safe for use by several threads.
class ClockDoubt {
 public:
  static constexpr std::int64_t kJumpMsMin = 3'600'000;
  static constexpr std::int64_t kDoubtMs = 24 * 3'600'000;

  explicit ClockDoubt(Clock wall, Clock steady = boot_clock_ms);
  bool is_doubtful();

 private:
  const Clock wall_;
  const Clock steady_;
  std::mutex mutex_;                              ///< of what follows
  std::int64_t believed_ms_;                      ///< by which wall was ahead of steady when last believed
  std::optional<std::int64_t> doubted_since_ms_;  ///< by steady
};

}  // namespace server
