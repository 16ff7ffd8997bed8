#include "server/log.h"

#include <gtest/gtest.h>

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
