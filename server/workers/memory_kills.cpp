#include "server/workers/memory_kills.h"

#include <algorithm>
#include <utility>

namespace server {
namespace {

/// From a kill to its death being seen: the supervisor looks ten times a second.
constexpr std::chrono::seconds kRecent{2};
/// What grows is larger when it dies than what was larger when it was chosen.
constexpr double kNearlyAsLarge = 0.8;

}  // namespace

MemoryKills::MemoryKills(std::function<std::int64_t()> count)
    : count_(std::move(count)), explained_(count_()), seen_(explained_) {}

void MemoryKills::look(Clock::time_point now) {
  if (const std::int64_t counted = count_(); counted != seen_) {
    seen_ = counted;
    seen_at_ = now;
  } else if (now - seen_at_ >= kRecent) {
    explained_ = seen_;
  }
}

std::vector<KilledFor> MemoryKills::judge(const std::vector<std::int64_t>& peak_bytes,
                                          std::int64_t largest_alive_bytes) {
  const std::int64_t kills = count_() - explained_;
  const auto may_be_chosen = [&](std::int64_t bytes) {
    return kills > 0 &&
           static_cast<double>(bytes) >= kNearlyAsLarge * static_cast<double>(largest_alive_bytes);
  };
  const std::int64_t meant = std::count_if(peak_bytes.begin(), peak_bytes.end(), may_be_chosen);
  std::vector<KilledFor> why;
  for (const std::int64_t bytes : peak_bytes)
    why.push_back(!may_be_chosen(bytes) ? KilledFor::another_end
                  : meant <= kills      ? KilledFor::memory
                                        : KilledFor::perhaps);
  explained_ += std::min(meant, kills);
  return why;
}

}  // namespace server
