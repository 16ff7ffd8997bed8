// The service over a real socket: requests that two programs could read in two ways, and clients that
// dribble.
#include "tests/unit/server/socket_fixture.h"

namespace server {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr std::string_view kNext = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";

class HostileSocketTest : public SocketTest {
 protected:
  static std::string head(const std::string& line, const std::string& fields = "") {
    return line + " HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n";
  }
  static int status_in(const std::string& answers) {
    return answers.size() > 12 ? std::atoi(answers.c_str() + 9) : 0;
  }
  static std::size_t answers_in(const std::string& text) {
    constexpr std::string_view kInEach = "\r\nX-Request-Id: ";
    std::size_t count = 0;
    for (std::size_t at = text.find(kInEach); at != text.npos; at = text.find(kInEach, at + 1)) ++count;
    return count;
  }
  /// One answer with this status, and the connection is closed, whatever follows on it.
  void expect_refused(const std::string& request, const std::vector<int>& statuses) {
    Connection connection(http_->port());
    connection.say(request + std::string(kNext));
    const std::string all = connection.everything();
    EXPECT_EQ(answers_in(all), 1u) << request << all;
    EXPECT_NE(std::find(statuses.begin(), statuses.end(), status_in(all)), statuses.end()) << request << all;
    EXPECT_NE(all.find("application/problem+json"), all.npos) << all;
  }
};

TEST_F(HostileSocketTest, AHeaderMeansWhatStandsThereAndNothingDecoded) {
  const std::string body = upload_body("v 0 0 0");
  expect_refused(upload_head("Transfer-Encoding: %63hunked\r\n") + chunked(body, 50), {501});
  expect_refused(upload_head("Content-Length: %35\r\n") + body, {400});
  EXPECT_EQ(status_of(head("GET /healthz", "X-Request-Id: a%41\r\n")), 200);
  EXPECT_EQ(ask(head("GET /healthz", "X-Request-Id: a%41\r\n")).find("X-Request-Id: aA"), std::string::npos);
  expect_nothing_kept();
}

TEST_F(HostileSocketTest, ALengthIsSaidOnceAndIsANumberThatFits) {
  const std::string body = upload_body("v 0 0 0"), size = std::to_string(body.size());
  for (const std::string& number : {std::string("18446744073709551615"), std::string("9223372036854775808"),
                                    std::string("99999999999999999999999")}) {
    expect_refused(upload_head("Content-Length: " + number + "\r\n") + body, {413});
    expect_refused(head("PUT /echo", "Content-Length: " + number + "\r\n") + body, {413});
  }
  for (const std::string lines : {"Content-Length: -1", "Content-Length: abc", "Content-Length: +5",
                                  "Content-Length:", "Content-Length: 5, 6", "Content-Length: 0x10",
                                  "Transfer-Encoding: chunked\r\nTransfer-Encoding: identity"})
    expect_refused(upload_head(lines + "\r\n") + body, {400});
  for (const std::string& lines : std::vector<std::string>{
           "Content-Length: " + size + "\r\nContent-Length: " + std::to_string(body.size() - 1),
           "Content-Length: 0\r\nContent-Length: " + size,
           "Content-Length: " + size + "\r\nTransfer-Encoding: chunked",
           "Content-Length: 0\r\nTransfer-Encoding: chunked", "Content-Length : " + size})
    expect_refused(upload_head(lines + "\r\n") + body, {400});
  for (const char* coding : {"identity", "gzip, chunked", "chunked, chunked", "xchunked"})
    expect_refused(upload_head(std::string("Transfer-Encoding: ") + coding + "\r\n") + chunked(body, 50),
                   {501});
  expect_nothing_kept();
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 0u);
}

TEST_F(HostileSocketTest, AChunkThatIsNoneEndsTheConnection) {
  const std::string body = upload_body("v 0 0 0");
  std::array<char, 20> hex{};
  std::snprintf(hex.data(), hex.size(), "%zx", body.size());
  const std::string good = hex.data();
  for (const std::string& size :
       {"-" + good, "+" + good, "0x" + good, " " + good, good + " x", std::string("zz"),
        std::string("ffffffffffffffffffff"), std::string("fffffffffffffffe"), std::string(),
        good + ";" + std::string(100'000, 'e')})
    expect_refused(upload_head("Transfer-Encoding: chunked\r\n") + size + "\r\n" + body + "\r\n0\r\n\r\n",
                   {400, 413});
  expect_refused(upload_head("Transfer-Encoding: chunked\r\n") + good + "\n" + body + "\r\n0\r\n\r\n", {400});
  expect_refused(upload_head("Transfer-Encoding: chunked\r\n") + good + "\r\n" + body + "0\r\n\r\n", {400});
  expect_nothing_kept();
  EXPECT_EQ(status_of(upload_head("Transfer-Encoding: chunked\r\n") + good + ";a=b\r\n" + body +
                      "\r\n0\r\nTrailer: x\r\n\r\n"),
            202)
      << "as it must be said";
}

TEST_F(HostileSocketTest, WhatFollowsABodyIsTheNextRequestAndWhatIsInItIsNone) {
  const std::string hidden = head("DELETE /v1/jobs/" + submit().id);
  Connection connection(http_->port());
  connection.say(head("PUT /echo", "Content-Length: " + std::to_string(hidden.size()) + "\r\n") + hidden +
                 std::string(kNext) + head("GET /version", "Connection: Close\r\n"));
  const std::string all = connection.everything();
  EXPECT_EQ(answers_in(all), 3u) << all;
  EXPECT_NE(all.find("/echo " + std::to_string(hidden.size())), all.npos) << all;
  EXPECT_NE(all.find("worker_sandbox"), all.npos) << "requests that come together are all answered";
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 1u);
}

TEST_F(HostileSocketTest, AnUploadWithoutALengthIs411AndSwallowsNothing) {
  for (const char* line : {"POST /v1/jobs", "POST /v1/validate"})
    expect_refused(head(line, "Content-Type: multipart/form-data; boundary=edge\r\n"), {411});
  expect_refused(head("PUT /v1/blobs/sha256/" + std::string(64, 'a')), {411});
}

TEST_F(HostileSocketTest, ARefusedBodyThatDribblesHoldsNoThread) {
  ASSERT_TRUE(tokens_->create("a", *parse_scopes("jobs:read"), 0, std::nullopt));
  Connection connection(http_->port());
  const auto begun = SteadyClock::now();
  connection.say(upload_head("Content-Length: 1000000\r\n"));
  std::thread dribble([&] {
    for (int i = 0; i < 40; ++i, std::this_thread::sleep_for(100ms)) connection.say("v");
  });
  const std::string all = connection.everything();
  const auto elapsed = SteadyClock::now() - begun;
  dribble.join();
  EXPECT_EQ(status_in(all), 401) << all;
  EXPECT_LT(elapsed, 3s);
}

TEST_F(HostileSocketTest, AHeadThatDribblesIs408) {
  stop();
  http_rules_.head_patience = 300ms;
  start();
  Connection connection(http_->port());
  const auto begun = SteadyClock::now();
  connection.say("GET /healthz HTTP/1.1\r\nHost: localh");
  std::thread dribble([&] {
    for (int i = 0; i < 40; ++i, std::this_thread::sleep_for(50ms)) connection.say("o");
  });
  EXPECT_EQ(connection.status(), 408);
  EXPECT_LT(SteadyClock::now() - begun, 2s);
  dribble.join();
}

TEST_F(HostileSocketTest, AnUpgradeIsAsIfItWereNotAskedFor) {
  Connection connection(http_->port());
  connection.say(head("GET /v1/jobs",
                      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"));
  const std::string text = connection.answer();
  EXPECT_EQ(status_in(text), 200);
  EXPECT_NE(text.find("Content-Length: "), text.npos) << "the client knows where the answer ends";
  connection.say(kNext);
  EXPECT_EQ(connection.status(), 200);
}

TEST_F(HostileSocketTest, OnlyWeLookAtRanges) {
  router_.add("GET", "/digits", [](const HttpRequest&, const PathValues&) {
    HttpAnswer answer;
    answer.content_type = "text/plain";
    answer.body = "0123456789";
    answer.ranges = true;
    return answer;
  });
  const auto with = [&](const std::string& range) {
    return ask(head("GET /digits", "Range: " + range + "\r\n"));
  };
  for (const char* none : {"bytes=5-2", "items=0-1", "bytes=abc", "bytes=", "bytes=-", "bytes=0-1,3-4", "0-1",
                           "bytes=-5-2", "bytes=+1-2"}) {
    const std::string text = with(none);
    EXPECT_TRUE(text.starts_with("HTTP/1.1 200 ") && text.ends_with("0123456789")) << none << text;
  }
  for (const char* some : {"bytes=2-4", "Bytes=2-4", "BYTES=2-4"}) {
    const std::string text = with(some);
    EXPECT_TRUE(text.starts_with("HTTP/1.1 206 ") && text.ends_with("\r\n\r\n234")) << some << text;
  }
  EXPECT_TRUE(with("bytes=7-99999999999999999999999").ends_with("\r\n\r\n789"));
  for (const char* outside : {"bytes=10-", "bytes=99999999999999999999999-", "bytes=-0"}) {
    const std::string text = with(outside);
    EXPECT_TRUE(text.starts_with("HTTP/1.1 416 ")) << outside << text;
    EXPECT_NE(text.find("Content-Range: bytes */10\r\n"), text.npos) << text;
  }
}

TEST_F(HostileSocketTest, HostIsSaidOnceAndAnAbsoluteTargetNamesIt) {
  expect_refused("GET /healthz HTTP/1.1\r\n\r\n", {400});
  expect_refused(head("GET /healthz", "Host: localhost\r\n"), {400});
  expect_refused(head("GET http://example.com/healthz"), {400});
  expect_refused(head("GET healthz"), {400});
  EXPECT_EQ(status_of(head("GET http://localhost/healthz")), 200);
  EXPECT_EQ(status_of("GET /healthz HTTP/1.0\r\n\r\n"), 200) << "HTTP/1.0 has no Host";
}

TEST_F(HostileSocketTest, AnEncodedSlashPartsNoNames) {
  for (const char* path : {"/v1%2Fjobs", "/v1%2fjobs", "/v1%252Fjobs", "/v1/jobs%2Fx%2Fcancel"})
    EXPECT_EQ(status_of(head(std::string("GET ") + path)), 404) << path;
  EXPECT_EQ(status_of(head("GET /%76%31/jobs")), 200) << "other characters are what they are";
}

TEST_F(HostileSocketTest, LinesThatEndWronglyAndNamesThatAreNoneAreRefused) {
  for (const char* request :
       {"GET /healthz HTTP/1.1\nHost: localhost\n\n",
        "GET /healthz HTTP/1.1\r\nHost: localhost\nX: y\r\n\r\n",
        "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX: a\rb\r\n\r\n",
        "GET /healthz HTTP/1.1\r\nHost: localhost\r\n folded\r\n\r\n",
        "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX Y: z\r\n\r\n",
        "GET /healthz HTTP/1.1\r\nHost: localhost\r\n: z\r\n\r\n", "GET /healthz\r\nHost: localhost\r\n\r\n",
        "GET  /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"})
    expect_refused(request, {400});
  expect_refused("GET /healthz HTTP/2.0\r\nHost: localhost\r\n\r\n", {505});
  expect_refused(head("BREW /healthz"), {501});
  expect_refused(head("GET /healthz", "X: " + std::string(9000, 'a') + "\r\n"), {431});
  std::string many;
  for (int i = 0; i < 200; ++i) many += "X-" + std::to_string(i) + ": y\r\n";
  expect_refused(head("GET /healthz", many), {431});
}

TEST_F(HostileSocketTest, ALoginIsShort) {
  stop();
  add_login_routes(router_, *tokens_, [] { return std::int64_t{0}; });
  start();
  expect_refused(head("POST /v1/login", "Content-Length: 1000000\r\n"), {413});
  expect_refused(head("POST /v1/login", "Content-Length: 4097\r\n") + std::string(4097, ' '), {413});
  expect_refused(
      head("POST /v1/login", "Transfer-Encoding: chunked\r\n") + chunked(std::string(5000, ' '), 1000),
      {413});
}

TEST_F(HostileSocketTest, ContentThatCannotBeMadeEndsItsAnswerOnly) {
  router_.add("GET", "/thrower", [](const HttpRequest&, const PathValues&) {
    HttpAnswer answer;
    answer.content_type = "text/plain";
    answer.stream = [](std::string& piece) -> bool {
      piece = "begun";
      throw std::bad_alloc();
    };
    return answer;
  });
  router_.add("GET", "/made", [](const HttpRequest&, const PathValues&) {
    HttpAnswer answer;
    answer.content_type = "text/plain";
    answer.file = std::make_shared<FileBody>();
    answer.file->bytes = 1000;
    answer.file->made = [](std::int64_t, char*, std::int64_t) -> std::int64_t { throw std::bad_alloc(); };
    return answer;
  });
  for (const char* path : {"/thrower", "/made"}) {
    Connection connection(http_->port());
    connection.say(head(std::string("GET ") + path));
    EXPECT_TRUE(connection.everything().starts_with("HTTP/1.1 200 "));
  }
  EXPECT_EQ(status_of(kNext), 200);
}

}  // namespace
}  // namespace server
