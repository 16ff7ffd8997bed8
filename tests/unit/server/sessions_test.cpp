#include "server/auth/sessions.h"

#include <gtest/gtest.h>

namespace server {
namespace {

TEST(Sessions, AreFewAndEnd) {
  Sessions sessions({100, 2, 3});
  const std::string first = *sessions.begin("a", 0), second = *sessions.begin("a", 1);
  EXPECT_NE(first, second);
  EXPECT_EQ(first.size(), 64u);
  EXPECT_EQ(sessions.token_of(first, 99), "a");
  EXPECT_EQ(sessions.token_of(first, 100), std::nullopt);
  EXPECT_EQ(sessions.token_of("", 0), std::nullopt);
  const std::string third = *sessions.begin("a", 2);
  EXPECT_EQ(sessions.token_of(first, 3), std::nullopt) << "the oldest makes room";
  const std::string b = *sessions.begin("b", 3), c = *sessions.begin("c", 3);
  EXPECT_EQ(sessions.count(), 3u);
  EXPECT_EQ(sessions.token_of(second, 3), std::nullopt);
  EXPECT_EQ(sessions.token_of(third, 3), "a");
  ASSERT_TRUE(sessions.begin("d", 200));
  EXPECT_EQ(sessions.count(), 1u) << "what is over is forgotten";
}

}  // namespace
}  // namespace server
