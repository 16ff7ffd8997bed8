#include "server/log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <thread>

#include "api/json/json_text.h"

namespace server {
namespace {

std::string logged(LogFormat format, const std::function<void()>& say) {
  set_log_format(format);
  testing::internal::CaptureStderr();
  say();
  return testing::internal::GetCapturedStderr();
}

TEST(Log, EachLineIsOneObjectWhateverStrangersSend) {
  const std::string text = logged(LogFormat::json, [] {
    log_event(
        "request",
        {{"path", std::string("/a\n\"}{\xFF\x01")}, {"status", std::int64_t{404}}, {"duration_ms", 0.25}});
    log_line("second\nline");
  });
  ASSERT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  const auto first = api::parse_json(text.substr(0, text.find('\n')), "log");
  ASSERT_TRUE(first) << text;
  EXPECT_EQ(first->at("message"), "request");
  EXPECT_EQ(first->at("status"), 404);
  EXPECT_EQ(first->at("duration_ms"), 0.25);
  EXPECT_EQ(first->at("path").get<std::string>().substr(0, 6), "/a\n\"}{");
  EXPECT_FALSE(first->contains("request_id"));
}

TEST(Log, LinesOfARequestCarryItsIdOnItsOwnThread) {
  const std::string text = logged(LogFormat::json, [] {
    set_log_request_id("abc");
    log_line("during");
    std::thread([] { log_line("elsewhere"); }).join();
    set_log_request_id("");
    log_line("after");
  });
  EXPECT_NE(text.find("\"during\",\"request_id\":\"abc\""), std::string::npos) << text;
  EXPECT_EQ(text.find("abc", text.find("elsewhere")), std::string::npos) << text;
}

TEST(Log, APipeThatNobodyReadsCostsLinesAndNoTime) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const int before = ::dup(STDERR_FILENO);
  ASSERT_EQ(::dup2(ends[1], STDERR_FILENO), STDERR_FILENO);
  set_log_format(LogFormat::text);
  const std::uint64_t lost = log_lines_lost();
  const std::string line(1000, 'x');
  for (int i = 0; i < 1000; ++i) log_line(line);  // a megabyte, of which the pipe holds a part
  const std::uint64_t more = log_lines_lost() - lost;
  EXPECT_GT(more, 100u);
  EXPECT_LT(more, 1000u);

  std::string text(std::size_t{1} << 20, '\0');
  text.resize(static_cast<std::size_t>(::read(ends[0], text.data(), text.size())));
  log_line("read again");
  std::string told(4096, '\0');
  told.resize(static_cast<std::size_t>(::read(ends[0], told.data(), told.size())));
  ::dup2(before, STDERR_FILENO);
  for (const int descriptor : {before, ends[0], ends[1]}) ::close(descriptor);
  EXPECT_NE(told.find("lines of the log were lost, count " + std::to_string(more) + "\n"), std::string::npos)
      << told;
  EXPECT_TRUE(told.ends_with("\nkeylume-server: read again\n")) << told;
}

TEST(Log, APipeThatWasClosedOrAFullDiskIsNoReasonToStop) {
  ::signal(SIGPIPE, SIG_IGN);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ::close(ends[0]);
  const int full = ::open("/dev/full", O_WRONLY);
  const int before = ::dup(STDERR_FILENO);
  const std::uint64_t lost = log_lines_lost();
  for (const int target : {ends[1], full}) {
    ::dup2(target, STDERR_FILENO);
    log_line("to nobody");
  }
  ::dup2(before, STDERR_FILENO);
  for (const int descriptor : {before, full, ends[1]}) ::close(descriptor);
  EXPECT_EQ(log_lines_lost() - lost, 2u);
  const std::string text = logged(LogFormat::text, [] { log_line("again"); });
  EXPECT_EQ(text, "keylume-server: lines of the log were lost, count 2\nkeylume-server: again\n");
}

TEST(Log, TextIsForPeopleAndStaysOnItsLine) {
  const std::string text = logged(LogFormat::text, [] {
    log_event(
        "request",
        {{"path", std::string("/a\nb\x1b[31m")}, {"owner", std::string()}, {"status", std::int64_t{200}}});
  });
  EXPECT_EQ(text, "keylume-server: request, path /a?b?[31m, owner -, status 200\n");
}

}  // namespace
}  // namespace server
