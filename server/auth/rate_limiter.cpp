#include "server/auth/rate_limiter.h"

#include <algorithm>
#include <cmath>

namespace server {
namespace {

// Names come from strangers' addresses: so many are remembered, then those who have not asked for a while
// are forgotten, then everybody.
constexpr std::size_t kBucketsMax = 20'000;

}  // namespace

double RateLimiter::held_at(const Bucket& bucket, Time now) const {
  const std::chrono::duration<double> elapsed = now - bucket.at;
  return std::min(rules_.burst, bucket.held + std::max(0.0, elapsed.count()) * rules_.per_second);
}

void RateLimiter::forget_the_full(Time now) {
  std::erase_if(buckets_, [&](const auto& entry) { return held_at(entry.second, now) >= rules_.burst; });
  if (buckets_.size() >= kBucketsMax) buckets_.clear();
}

RateLimiter::Answer RateLimiter::ask(std::string_view who, Time now) {
  if (!on()) return {};
  const std::lock_guard lock(mutex_);
  auto found = buckets_.find(who);
  if (found == buckets_.end()) {
    if (buckets_.size() >= kBucketsMax) forget_the_full(now);
    found = buckets_.emplace(std::string(who), Bucket{rules_.burst, now}).first;
  }
  Bucket& bucket = found->second;
  bucket.held = held_at(bucket, now);
  bucket.at = now;
  Answer answer;
  answer.allowed = bucket.held >= 1;
  if (answer.allowed) bucket.held -= 1;
  answer.remaining = static_cast<std::size_t>(bucket.held);
  if (bucket.held < 1)
    answer.wait_seconds = static_cast<std::size_t>(std::ceil((1 - bucket.held) / rules_.per_second));
  return answer;
}

}  // namespace server
