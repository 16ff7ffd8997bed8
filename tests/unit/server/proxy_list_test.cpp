#include "server/http/proxy_list.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

namespace server {
namespace {

using namespace std::chrono_literals;

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

TEST(ProxyList, KnowsAnAddressOfIpv4AlsoAsASocketForBothWritesIt) {
  ProxyList list({"10.0.0.1", "::ffff:10.0.0.2", "localhost"});
  for (const char* address : {"::ffff:10.0.0.1", "10.0.0.2", "::ffff:10.0.0.2", "::ffff:127.0.0.1"})
    EXPECT_TRUE(list.has(address)) << address;
  EXPECT_FALSE(list.has("::ffff:10.0.0.3"));
  EXPECT_FALSE(list.has("::ffff:a00:1")) << "the system does not write it so";
}

/// A server of names as the test wants it. Shared with the thread of a list, which may outlive that.
struct NameServer {
  std::atomic<int> asked = 0;
  std::atomic<bool> is_silent = false, is_down = false, is_gone = false, second = false;

  std::optional<AddressSet> answer() {
    ++asked;
    while (is_silent) std::this_thread::sleep_for(1ms);
    if (is_down) return std::nullopt;
    if (is_gone) return AddressSet{};
    return AddressSet{second ? "10.0.0.2" : "10.0.0.1"};
  }
};

class ProxyNames : public testing::Test {
 protected:
  ProxyRules rules() {
    ProxyRules rules;
    rules.look_up = [server = server_](const std::string&) { return server->answer(); };
    rules.look_every = 40ms;
    rules.look_again_after = 10ms;
    rules.keep_for = 400ms;
    rules.first_patience = 50ms;
    return rules;
  }
  static bool soon(const std::function<bool()>& is_so) {
    for (int k = 0; k < 500; ++k, std::this_thread::sleep_for(10ms))
      if (is_so()) return true;
    return false;
  }
  void TearDown() override { server_->is_silent = false; }

  const std::shared_ptr<NameServer> server_ = std::make_shared<NameServer>();
};

TEST_F(ProxyNames, AreKeptForAWhileWhereNobodyCanSay) {
  ProxyList list({"front"}, rules());
  ASSERT_TRUE(list.has("10.0.0.1"));
  server_->is_down = true;
  const int before = server_->asked;
  ASSERT_TRUE(soon([&] { return server_->asked > before + 1; }));
  EXPECT_TRUE(list.has("10.0.0.1"));
  EXPECT_TRUE(soon([&] { return !list.has("10.0.0.1"); })) << "but not for ever";
}

TEST_F(ProxyNames, OfAnotherAddressAreNoticedSoon) {
  ProxyList list({"front"}, rules());
  ASSERT_TRUE(list.has("10.0.0.1"));
  server_->second = true;
  EXPECT_TRUE(soon([&] { return list.has("10.0.0.2"); }));
  EXPECT_FALSE(list.has("10.0.0.1"));
}

TEST_F(ProxyNames, ThatStandForNoMachineAnyMoreAreForgottenAtOnce) {
  ProxyRules rules = this->rules();
  rules.keep_for = 1h;
  ProxyList list({"front"}, rules);
  ASSERT_TRUE(list.has("10.0.0.1"));
  server_->is_gone = true;
  EXPECT_TRUE(soon([&] { return !list.has("10.0.0.1"); })) << "the address may be a stranger's by now";
}

TEST_F(ProxyNames, AreAskedForBeforeWhoSpeaksAsAProxyIsTakenForAStranger) {
  ProxyRules rules = this->rules();
  rules.look_every = 1h;
  rules.look_again_after = 0ms;
  rules.patience = 20s;
  ProxyList list({"front"}, rules);
  ASSERT_TRUE(list.has("10.0.0.1"));
  server_->second = true;
  EXPECT_TRUE(list.has("10.0.0.2", true)) << "at the first time";
}

TEST_F(ProxyNames, MakeNobodyWait) {
  server_->is_silent = true;
  const auto began = std::chrono::steady_clock::now();
  {
    ProxyList list({"front"}, rules());
    for (int k = 0; k < 100; ++k) EXPECT_FALSE(list.has("10.0.0.1"));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s) << "the server of names still says nothing";
}

}  // namespace
}  // namespace server
