#include "server/http/proxy_list.h"

#include <gtest/gtest.h>

namespace server {
namespace {

TEST(ProxyList, KnowsAddressesHoweverTheyWereWritten) {
  ProxyList list({"10.0.0.1", "2001:0DB8::0:1"});
  EXPECT_TRUE(list.has("10.0.0.1"));
  EXPECT_TRUE(list.has("2001:db8::1"));
  EXPECT_FALSE(list.has("10.0.0.2"));
}

TEST(ProxyList, KnowsTheMachinesThatANameStandsFor) {
  ProxyList list({"localhost"});
  EXPECT_TRUE(list.has("127.0.0.1"));
  EXPECT_FALSE(list.has("10.0.0.1"));
}

TEST(ProxyList, ANameThatNobodyKnowsIsNobody) {
  ProxyList list({"no-such-machine.invalid"});
  EXPECT_FALSE(list.has("127.0.0.1"));
}

}  // namespace
}  // namespace server
