#include "server/auth/rate_limiter.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace server {
namespace {

// Of those who are remembered, so many are forgotten at once, so that not every newcomer costs a look at all.
constexpr std::size_t kForgottenShare = 8;

}  // namespace

double RateLimiter::held_at(const Bucket& bucket, Time now) const {
  const std::chrono::duration<double> elapsed = now - bucket.at;
  return std::min(rules_.burst, bucket.held + std::max(0.0, elapsed.count()) * rules_.per_second);
}

void RateLimiter::forget_the_full(Time now) {
  std::erase_if(buckets_, [&](const auto& entry) { return held_at(entry.second, now) >= rules_.burst; });
  if (buckets_.size() < kBucketsMax) return;
  // Nobody is forgiven what he has spent because others came: those who have spent least go.
  std::vector<double> held;
  held.reserve(buckets_.size());
  for (const auto& entry : buckets_) held.push_back(held_at(entry.second, now));
  const std::size_t gone = buckets_.size() / kForgottenShare;
  const auto least = held.begin() + static_cast<std::ptrdiff_t>(gone);
  std::nth_element(held.begin(), least, held.end(), std::greater<>());
  std::size_t left = gone;
  std::erase_if(buckets_, [&](const auto& entry) {
    if (left == 0 || held_at(entry.second, now) < *least) return false;
    --left;
    return true;
  });
}

std::size_t RateLimiter::remembered() {
  const std::lock_guard lock(mutex_);
  return buckets_.size();
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

std::string network_of(std::string_view address) {
  in6_addr bytes{};
  const std::string text(address.substr(0, address.find('%')));  // fe80::1%eth0
  if (::inet_pton(AF_INET6, text.c_str(), &bytes) != 1) return std::string(address);
  std::array<char, INET6_ADDRSTRLEN> shown{};
  if (IN6_IS_ADDR_V4MAPPED(&bytes))
    return ::inet_ntop(AF_INET, bytes.s6_addr + 12, shown.data(), shown.size());
  std::fill(bytes.s6_addr + 8, bytes.s6_addr + 16, std::uint8_t{0});
  return std::string(::inet_ntop(AF_INET6, &bytes, shown.data(), shown.size())) + "/64";
}

}  // namespace server
