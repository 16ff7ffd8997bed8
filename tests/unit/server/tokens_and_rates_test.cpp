// The texts of tokens, and who has asked how often: without a service around them.
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <string>

#include "server/auth/rate_limiter.h"
#include "server/auth/token_text.h"

namespace server {
namespace {

TEST(TokenText, HasItsFormAndIsNeverTheSame) {
  std::set<std::string> texts;
  for (int i = 0; i < 200; ++i) {
    const auto text = new_token_text();
    ASSERT_TRUE(text);
    EXPECT_EQ(text->size(), 3 + 8 + 1 + 43u);
    EXPECT_EQ(prefix_of(*text), text->substr(3, 8));
    EXPECT_TRUE(texts.insert(*text).second);
  }
  const std::string good = *texts.begin();
  for (const std::string& bad : {std::string(), good + "a", good.substr(1), "kx" + good.substr(2),
                                 "kl_../..//_" + good.substr(12), good.substr(0, 20) + "/" + good.substr(21)})
    EXPECT_EQ(prefix_of(bad), std::nullopt) << bad;
}

TEST(TokenText, ComparesWholeTexts) {
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  for (const char* other : {"abd", "bbc", "ab", "abcd", ""})
    EXPECT_FALSE(equal_in_constant_time("abc", other));
}

TEST(RateLimiter, GivesABurstThenWhatFlowsIn) {
  RateLimiter limiter({2, 4});
  const RateLimiter::Time start{};
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(limiter.ask("a", start).allowed) << i;
  const auto refused = limiter.ask("a", start);
  EXPECT_FALSE(refused.allowed);
  EXPECT_EQ(refused.wait_seconds, 1u);
  EXPECT_TRUE(limiter.ask("b", start).allowed) << "others are not affected";
  EXPECT_TRUE(limiter.ask("a", start + std::chrono::milliseconds(500)).allowed);
  EXPECT_FALSE(limiter.ask("a", start + std::chrono::milliseconds(500)).allowed);
  EXPECT_EQ(limiter.ask("a", start + std::chrono::hours(1)).remaining, 3u) << "never more than a burst";
}

TEST(RateLimiter, RemembersStrangersWithinBounds) {
  RateLimiter limiter({1, 2});
  const RateLimiter::Time start{};
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(limiter.ask("greedy", start).allowed);
  for (int i = 0; i < 60'000; ++i) {
    EXPECT_TRUE(limiter.ask("from " + std::to_string(i), start).allowed);
    ASSERT_LE(limiter.remembered(), kBucketsMax);
  }
  EXPECT_GT(limiter.remembered(), kBucketsMax / 2) << "most are";
  EXPECT_FALSE(limiter.ask("greedy", start).allowed) << "a crowd of strangers gives nobody his requests back";
}

TEST(RateLimiter, KnowsANetworkNotEachOfItsAddresses) {
  EXPECT_EQ(network_of("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(network_of("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
  EXPECT_EQ(network_of("2001:db8:1:2::1"), network_of("2001:0db8:1:2:ffff::"));
  EXPECT_NE(network_of("2001:db8:1:2::1"), network_of("2001:db8:1:3::1"));
  EXPECT_EQ(network_of("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(network_of("fe80::1%eth0"), "fe80::/64");
  EXPECT_EQ(network_of("no address"), "no address");
}

}  // namespace
}  // namespace server
