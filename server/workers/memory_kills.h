// Whom did the kernel kill for want of memory? The control group only counts how many.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/workers/control_group.h"

namespace server {

/// A worker that SIGKILL ended, and that none of us had sent it.
enum class KilledFor {
  memory,      ///< the kernel killed as many as could have been meant
  perhaps,     ///< fewer: this one is as good a guess as others
  another_end  ///< none was killed for memory lately, or what the kernel chooses, the largest, was another
};

/// Keeps account of the group's kills, so that each explains one death at most. One thread at a time.
class MemoryKills {
 public:
  using Clock = std::chrono::steady_clock;

  /// count: of all kills in the group so far, as out_of_memory_kills().
  explicit MemoryKills(std::function<std::int64_t()> count = [] { return out_of_memory_kills(); });

  /// To be called often, after the dead of that time were judged: a kill is put down to deaths that are seen
  /// within two seconds, and to none after them. It was of a process that is none of the workers.
  void look(Clock::time_point now = Clock::now());

  /// Of workers that were seen dead together. peak_bytes: the most each was resident with;
  /// largest_alive_bytes: of those that live. All are as willing to be killed (oom_score_adj), so that the
  /// kernel chooses by size.
  std::vector<KilledFor> judge(const std::vector<std::int64_t>& peak_bytes, std::int64_t largest_alive_bytes);

 private:
  const std::function<std::int64_t()> count_;
  std::int64_t explained_, seen_;  ///< kills
  Clock::time_point seen_at_{};    ///< when the last of `seen_` was new
};

}  // namespace server
