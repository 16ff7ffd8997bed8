#include "server/config.h"

#include <gtest/gtest.h>

#include <vector>

namespace server {
namespace {

api::Result<CommandLine> parse(std::vector<std::string_view> words) {
  return parse_command_line(words);
}

/// With the two options that every good command line needs here.
api::Result<CommandLine> parse_also(std::vector<std::string_view> words) {
  words.insert(words.begin(), {"--data", "d", "--worker=/bin/sh"});
  return parse(words);
}

TEST(CommandLine, ReadsEveryOptionInBothForms) {
  const auto parsed =
      parse_also({"--listen", "127.0.0.1:9", "--worker-threads=3", "--max-upload-bytes", "1000"});
  ASSERT_TRUE(parsed) << parsed.error().message;
  const Config& config = std::get<Config>(*parsed);
  EXPECT_EQ(config.data, "d");
  EXPECT_EQ(config.worker, "/bin/sh");
  EXPECT_EQ(config.host, "127.0.0.1");
  EXPECT_EQ(config.port, 9);
  EXPECT_EQ(config.worker_threads, 3u);
  EXPECT_EQ(config.upload_bytes_max, 1000);
  EXPECT_EQ(std::get<Config>(*parse_also({"--listen", "[::1]:9"})).host, "::1");
}

TEST(CommandLine, KnowsWhichAddressesOnlyThisMachineReaches) {
  for (const char* host : {"0.0.0.0", "192.168.1.2", "::", "example.com", "127.example.com"})
    EXPECT_FALSE(is_loopback(host)) << host;
  for (const char* host : {"127.0.0.1", "127.9.9.9", "localhost", "::1"})
    EXPECT_TRUE(is_loopback(host)) << host;
}

TEST(CommandLine, LimitsHowOftenStrangersMayAsk) {
  const auto limit = [](std::vector<std::string_view> words) {
    const Config config = std::get<Config>(*parse_also(std::move(words)));
    return rate_limit(config, config.host);
  };
  EXPECT_EQ(limit({}), 0) << "who is on this machine may ask as often as it can";
  EXPECT_EQ(limit({"--listen", "0.0.0.0:80"}), 50);
  EXPECT_EQ(limit({"--listen", "0.0.0.0:80", "--rate-limit", "0"}), 0);
  EXPECT_EQ(limit({"--rate-limit=7"}), 7);
  const auto proxies = parse_also({"--proxy", "10.0.0.1", "--proxy=2001:0DB8::0:1"});
  EXPECT_EQ(std::get<Config>(*proxies).proxies, (std::vector<std::string>{"10.0.0.1", "2001:db8::1"}))
      << "as the system writes them";
  EXPECT_EQ(std::get<Config>(*parse_also({"--proxy=front-1.example.org"})).proxies,
            (std::vector<std::string>{"front-1.example.org"}));
}

TEST(CommandLine, NamesTheWordThatIsWrong) {
  const std::pair<std::vector<std::string_view>, std::string> cases[]{
      {{}, "--data"},
      {{"--data"}, "--data"},
      {{"--data", "d", "--worker", "/nonexistent"}, "/nonexistent"},
      {{"--data", "d", "--worker", "/bin/sh", "--dashboard", "/nonexistent"}, "/nonexistent"},
      {{"--data", "d", "--worker", "/bin/sh", "--no-such-option"}, "--no-such-option"},
      {{"--data", "d", "--worker", "/bin/sh", "stray"}, "stray"},
      {{"--data", "d", "--worker", "/bin/sh", "--listen", "8080"}, "8080"},
      {{"--data", "d", "--worker", "/bin/sh", "--listen", "127.0.0.1:x"}, "127.0.0.1:x"},
      {{"--data", "d", "--worker", "/bin/sh", "--listen", "127.0.0.1:70000"}, "70000"},
      {{"--data", "d", "--worker", "/bin/sh", "--worker-threads", "0"}, "--worker-threads"},
      {{"--data", "d", "--worker", "/bin/sh", "--max-upload-bytes", "-1"}, "--max-upload-bytes"},
      {{"--data", "d", "--worker", "/bin/sh", "--proxy", "127.0.0.1:80"}, "127.0.0.1:80"},
      {{"--data", "d", "--worker", "/bin/sh", "--proxy", "10.0.0.256"}, "10.0.0.256"},
  };
  for (const auto& [words, word] : cases) {
    const auto parsed = parse(words);
    ASSERT_FALSE(parsed) << word;
    EXPECT_NE(parsed.error().message.find(word), std::string::npos) << parsed.error().message;
  }
}

TEST(CommandLine, HelpAndVersionNeedNothingElse) {
  EXPECT_TRUE(std::holds_alternative<ShowHelp>(*parse({"--help"})));
  EXPECT_TRUE(std::holds_alternative<ShowVersion>(*parse({"--version"})));
}

}  // namespace
}  // namespace server
