// How often somebody may ask.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace server {

struct RateRules {
  double per_second = 0;  ///< requests in the long run; 0: as many as you like
  double burst = 200;     ///< requests at once
};

/// Names come from strangers' addresses: so many are remembered.
inline constexpr std::size_t kBucketsMax = 20'000;

/// Token buckets by name: each holds `burst`, every request takes one, `per_second` flow in. Where there are
/// too many names, the fullest buckets are forgotten first.
/// Safe for use by several threads.
class RateLimiter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit RateLimiter(RateRules rules) : rules_(rules) {}

  struct Answer {
    bool allowed = true;
    std::size_t remaining = 0;     ///< requests that may follow at once
    std::size_t wait_seconds = 0;  ///< until the next one may come; 0: at once
  };
  Answer ask(std::string_view who, Time now = std::chrono::steady_clock::now());

  std::size_t remembered();  ///< buckets, at most kBucketsMax

  bool on() const { return rules_.per_second > 0; }
  const RateRules& rules() const { return rules_; }

 private:
  struct Bucket {
    double held = 0;
    Time at;
  };
  double held_at(const Bucket& bucket, Time now) const;
  void forget_the_full(Time now);

  const RateRules rules_;
  std::mutex mutex_;
  std::map<std::string, Bucket, std::less<>> buckets_;
};

/// What one client is known by: an IPv4 address as it is, of an IPv6 one its network, "2001:db8::/64",
/// because whoever has one address there has 2^64. Anything else as it is.
std::string network_of(std::string_view address);

}  // namespace server
