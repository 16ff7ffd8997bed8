// For which hosts the service answers: a page whose name was rebound to our address has a name.
#include "server/http/origin.h"

#include <gtest/gtest.h>

namespace server {
namespace {

int status_for(const std::string& host, const HostRules& rules, const std::string& path = "/v1/jobs") {
  HttpRequest request{"GET", path, {}, {}};
  request.header = [host](std::string_view name) {
    return name == "Host" && !host.empty() ? std::optional(host) : std::nullopt;
  };
  const auto refused = refuse_stranger(request, rules);
  return refused ? refused->status : 0;
}

TEST(Hosts, OnLoopbackOnlyThisMachineIsAnswered) {
  const HostRules loopback{true};
  for (const char* host :
       {"localhost", "LOCALHOST:8080", "127.0.0.1", "127.9.9.9:1", "[::1]", "[::1]:8080", ""})
    EXPECT_EQ(status_for(host, loopback), 0) << host;
  for (const char* host :
       {"192.168.1.2", "[fe80::1]", "evil.example", "localhost.evil.example", "127.0.0.1.evil.example",
        "localhost:80:80", "[::1", "::1", "0x7f000001", "2130706433", "localhost."})
    EXPECT_EQ(status_for(host, loopback), 421) << host;
}

TEST(Hosts, OnAPublicAddressNumbersAreAnsweredAndNamesOnlyIfListed) {
  const HostRules open{false};
  for (const char* host :
       {"localhost:80", "192.168.1.2", "203.0.113.9:8080", "[2001:db8::1]:8080", "127.0.0.1"})
    EXPECT_EQ(status_for(host, open), 0) << host;
  for (const char* host : {"evil.example", "render.example.org", "192.168.1", "192.168.1.2.evil.example",
                           "[evil]", "[2001:db8::1", "203.0.113.9:8080x", "3232235778", "0300.0250.1.2"})
    EXPECT_EQ(status_for(host, open), 421) << host;
}

TEST(Hosts, NamesThatTheOperatorGaveAreAnsweredWithAnyPort) {
  for (const bool loopback : {true, false}) {
    const HostRules named{loopback, {"render.example.org", "keylume"}};
    for (const char* host : {"render.example.org", "Render.Example.ORG:443", "keylume:8080", "localhost"})
      EXPECT_EQ(status_for(host, named), 0) << host;
    for (const char* host :
         {"example.org", "a.render.example.org", "render.example.org.evil.example", "keylume2"})
      EXPECT_EQ(status_for(host, named), 421) << host;
  }
}

}  // namespace
}  // namespace server
