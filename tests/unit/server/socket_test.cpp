// The service over a real socket, with bytes that no decent client sends.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "server/http/http_server.h"
#include "server/http/routes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

constexpr std::int64_t kUploadBytesMax = 100'000;

/// One connection; everything on it is said by the test.
class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{8, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }

  void say(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return;  // the server has heard enough
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  void say_no_more() { ::shutdown(socket_.get(), SHUT_WR); }

  /// Header and body of one answer, the body by its Content-Length.
  std::string answer() {
    std::string text;
    for (;;) {
      const std::size_t head = text.find("\r\n\r\n");
      if (head != text.npos && text.size() >= head + 4 + body_bytes(text)) return text;
      std::array<char, 4096> piece{};
      const ssize_t count = ::recv(socket_.get(), piece.data(), piece.size(), 0);
      if (count <= 0) return text;
      text.append(piece.data(), static_cast<std::size_t>(count));
    }
  }

  int status() {
    const std::string text = answer();
    return text.size() > 12 ? std::atoi(text.c_str() + 9) : 0;
  }

 private:
  static std::size_t body_bytes(const std::string& text) {
    const std::size_t at = text.find("Content-Length: ");
    return at == text.npos ? 0 : static_cast<std::size_t>(std::atoll(text.c_str() + at + 16));
  }
  FileHandle socket_;
};

class SocketTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    add_job_routes(router_, *jobs_);
    add_result_routes(router_, *jobs_);
    add_service_routes(router_);
    http_rules_.port = 0;
    http_rules_.upload.total_bytes = kUploadBytesMax;
    start();
  }
  void TearDown() override { stop(); }

  void start() {
    http_ = std::make_unique<HttpServer>(router_, *jobs_, *folder_, http_rules_);
    ASSERT_TRUE(http_->bind());
    listener_ = std::thread([this] { http_->run(); });
  }
  void stop() {
    http_->stop();
    listener_.join();
  }

  std::string ask(std::string_view request) {
    Connection connection(http_->port());
    connection.say(request);
    return connection.answer();
  }
  int status_of(std::string_view request) {
    const std::string text = ask(request);
    return text.size() > 12 ? std::atoi(text.c_str() + 9) : 0;
  }

  static std::string upload_body(std::string_view scene) {
    return "--edge\r\nContent-Disposition: form-data; name=\"scene\"; filename=\"a.obj\"\r\n\r\n" +
           std::string(scene) +
           "\r\n--edge\r\nContent-Disposition: form-data; name=\"animation\"\r\n\r\n"
           R"({"frames": {"count": 3, "fps": 24}, "cameras": {"front": {"position": [0, 0, 5], "target": [0, 0, 0]}},
              "images": [{"camera": "front"}]})"
           "\r\n--edge--\r\n";
  }
  static std::string upload_head(std::string_view more_headers) {
    return "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; "
           "boundary=edge\r\n" +
           std::string(more_headers) + "\r\n";
  }
  static std::string chunked(std::string_view body, std::size_t piece_bytes) {
    std::string text;
    while (!body.empty()) {
      const std::string_view piece = body.substr(0, piece_bytes);
      std::array<char, 20> size{};
      std::snprintf(size.data(), size.size(), "%zx\r\n", piece.size());
      text += size.data() + std::string(piece) + "\r\n";
      body.remove_prefix(piece.size());
    }
    return text + "0\r\n\r\n";
  }

  void expect_nothing_kept() {
    EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
    EXPECT_TRUE(std::filesystem::is_empty(folder_->jobs()));
  }

  HttpRules http_rules_;
  Router router_;
  std::unique_ptr<HttpServer> http_;
  std::thread listener_;
};

TEST_F(SocketTest, AnUploadBecomesAJobWithItsLengthKnownOrInChunks) {
  const std::string body = upload_body("v 0 0 0");
  EXPECT_EQ(status_of(upload_head("Content-Length: " + std::to_string(body.size()) + "\r\n") + body), 202);
  EXPECT_EQ(status_of(upload_head("Transfer-Encoding: chunked\r\n") + chunked(body, 7)), 202);
  EXPECT_EQ(jobs_->list(std::nullopt, std::nullopt, 10)->jobs.size(), 2u);
}

TEST_F(SocketTest, AnUploadBeyondTheLimitIs413HoweverItIsSent) {
  const std::string body = upload_body(std::string(kUploadBytesMax + 1, 'v'));
  EXPECT_EQ(status_of(upload_head("Content-Length: " + std::to_string(body.size()) + "\r\n") + body), 413);
  EXPECT_EQ(status_of(upload_head("Transfer-Encoding: chunked\r\n") + chunked(body, 5000)), 413);
  EXPECT_EQ(status_of(upload_head("Content-Length: 1000000000000\r\n")), 413)
      << "by its own word, before the body";
  EXPECT_EQ(status_of(upload_head("Expect: 100-continue\r\nContent-Length: 1000000000000\r\n")), 413);
  expect_nothing_kept();
}

TEST_F(SocketTest, ABrokenOrUnfinishedBodyLeavesNothing) {
  const std::string body = upload_body("v 0 0 0");
  EXPECT_EQ(status_of(upload_head("Content-Length: 8\r\n") + "no parts"), 400);
  Connection connection(http_->port());
  connection.say(upload_head("Content-Length: " + std::to_string(body.size()) + "\r\n") +
                 body.substr(0, 100));
  connection.say_no_more();
  EXPECT_EQ(connection.status(), 400);
  EXPECT_EQ(status_of(upload_head("Transfer-Encoding: chunked\r\n") + "-2\r\nxx\r\n"), 400);
  EXPECT_EQ(status_of(upload_head("Content-Length: 5\r\nContent-Length: 6\r\n") + "hello"), 400);
  EXPECT_EQ(status_of(upload_head("Content-Length: 5\r\nTransfer-Encoding: chunked\r\n") + "0\r\n\r\n"), 400);
  EXPECT_EQ(status_of(upload_head("Content-Encoding: gzip\r\nContent-Length: 5\r\n") + "hello"), 415);
  expect_nothing_kept();
}

TEST_F(SocketTest, ARequestWithoutABodyIsAnsweredAtOnceAndTheNextOneOnTheSameConnectionToo) {
  Connection connection(http_->port());
  const auto start = std::chrono::steady_clock::now();
  connection.say("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(connection.status(), 200);
  const Job submitted = submit();
  connection.say("POST /v1/jobs/" + submitted.id + "/cancel HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(connection.status(), 202);
  connection.say("DELETE /v1/jobs/" + submitted.id + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(connection.status(), 204);
  connection.say("GET /version HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(connection.status(), 200);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(SocketTest, TwentyConnectionsThatStayOpenAreAllAnsweredAtOnce) {
  std::vector<std::unique_ptr<Connection>> connections;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 20; ++i) {
    connections.push_back(std::make_unique<Connection>(http_->port()));
    connections.back()->say("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  for (const auto& connection : connections) EXPECT_EQ(connection->status(), 200);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1500))
      << "before any of them has been idle for too long";
}

TEST_F(SocketTest, AnUploadThatTricklesInIs408) {
  stop();
  http_rules_.upload_grace = std::chrono::milliseconds(200);
  start();
  Connection connection(http_->port());
  connection.say(upload_head("Content-Length: 90000\r\n") + upload_body("v 0 0 0").substr(0, 100));
  for (int i = 0; i < 8; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    connection.say("v");
  }
  EXPECT_EQ(connection.status(), 408);
  expect_nothing_kept();
}

TEST_F(SocketTest, UploadsNeverTakeTheLastThread) {
  stop();
  http_rules_.uploads_max = 2;
  start();
  const std::string body = upload_body("v 0 0 0");
  const std::string head = upload_head("Content-Length: " + std::to_string(body.size()) + "\r\n");
  Connection first(http_->port());
  Connection second(http_->port());
  for (Connection* connection : {&first, &second}) connection->say(head + body.substr(0, 50));
  // A third that is asked before both have their places would take one of them.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::string refused;
  for (int i = 0; i < 100 && !refused.starts_with("HTTP/1.1 503"); ++i) refused = ask(head + "x");
  EXPECT_TRUE(refused.starts_with("HTTP/1.1 503")) << refused;
  EXPECT_NE(refused.find("Retry-After: "), std::string::npos);
  EXPECT_EQ(status_of("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"), 200);
  for (Connection* connection : {&first, &second}) {
    connection->say(body.substr(50));
    EXPECT_EQ(connection->status(), 202);
  }
  EXPECT_EQ(status_of(head + body), 202) << "their places are free again";
}

TEST_F(SocketTest, ARefusedUploadGivesItsConnectionBackAtOnce) {
  const auto start = std::chrono::steady_clock::now();
  const std::string body = "--edge\r\nContent-Disposition: form-data; name=\"scenery\"\r\n\r\n" +
                           std::string(60'000, 'v') + "\r\n--edge--\r\n";
  const std::string request = upload_head("Content-Length: " + std::to_string(body.size()) + "\r\n") + body;
  Connection refused(http_->port());
  refused.say(request);
  EXPECT_EQ(refused.status(), 422);
  EXPECT_EQ(refused.answer(), "") << "and is closed";
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(SocketTest, ALongBodyThatNobodyWantsHoldsNoThread) {
  const std::string length = "Content-Length: 1000000000\r\n";
  http_rules_.upload.total_bytes = 2'000'000'000;
  http_rules_.uploads_max = 0;
  stop();
  start();
  const std::pair<std::string, int> cases[]{
      {upload_head(length), 503},
      {"POST /v1/jobs HTTP/1.1\r\nHost: elsewhere\r\n" + length + "\r\n", 421},
      {"GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\n" + length + "\r\n", 413}};
  for (const auto& [request, status] : cases) {
    Connection connection(http_->port());
    const auto begun = std::chrono::steady_clock::now();
    connection.say(request);
    EXPECT_EQ(connection.status(), status);
    EXPECT_EQ(connection.answer(), "") << "and is closed";
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(3)) << status;
  }
}

TEST_F(SocketTest, EveryRefusalIsAProblemDocument) {
  const std::string cases[]{
      "GET /nowhere HTTP/1.1\r\nHost: localhost\r\n\r\n",
      "PUT /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n",
      "BREW /v1/jobs HTTP/1.1\r\nHost: localhost\r\n\r\n",
      "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\n\r\n",
      "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: "
      "2\r\n\r\n{}",
      "GET /v1/jobs?limit=0 HTTP/1.1\r\nHost: localhost\r\n\r\n",
      "GET /v1/jobs?cursor=x HTTP/1.1\r\nHost: localhost\r\n\r\n",
      "GET /v1/jobs?state=asleep HTTP/1.1\r\nHost: localhost\r\n\r\n",
      "GET /healthz HTTP/1.1\r\nHost: localhost\r\nRange: lines=1-2\r\n\r\n",
      "GET /" + std::string(9000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n",
  };
  for (const std::string& request : cases) {
    const std::string text = ask(request);
    EXPECT_NE(text.find("Content-Type: application/problem+json"), std::string::npos)
        << request.substr(0, 60) << "\n"
        << text.substr(0, 300);
    EXPECT_NE(text.find("X-Request-Id: "), std::string::npos);
    EXPECT_NE(text.find("X-Content-Type-Options: nosniff"), std::string::npos);
  }
}

TEST_F(SocketTest, ARequestIdIsGivenBackOnlyWhenItIsHarmless) {
  EXPECT_NE(ask("GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Request-Id: my.id-1\r\n\r\n")
                .find("X-Request-Id: my.id-1\r\n"),
            std::string::npos);
  EXPECT_EQ(ask("GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Request-Id: a%0d%0aSet-Cookie: b\r\n\r\n")
                .find("Set-Cookie"),
            std::string::npos);
}

TEST_F(SocketTest, ARequestForAnotherHostIsRefusedOnLoopback) {
  for (const char* host : {"localhost", "LocalHost:8080", "127.0.0.1", "127.9.9.9:1", "[::1]", "[::1]:8080"})
    EXPECT_EQ(status_of(std::string("GET /healthz HTTP/1.1\r\nHost: ") + host + "\r\n\r\n"), 200) << host;
  for (const char* host : {"rebound.example", "localhost.example", "127.0.0.1.example:80", "128.0.0.1",
                           "localhost:x", "[::2]", "[::1", "", "192.168.1.1:8080"})
    EXPECT_EQ(status_of(std::string("GET /v1/jobs HTTP/1.1\r\nHost: ") + host + "\r\n\r\n"), 421) << host;
  EXPECT_EQ(status_of("GET /healthz HTTP/1.1\r\n\r\n"), 200) << "no browser leaves it out";
  stop();
  http_rules_.this_machine_only = false;
  start();
  EXPECT_EQ(status_of("GET /healthz HTTP/1.1\r\nHost: render.example\r\n\r\n"), 200);
}

TEST_F(SocketTest, APageOfAnotherOriginMayChangeNothing) {
  const std::string id = submit().id;
  const auto cancel_from = [&](const std::string& origin) {
    return status_of("POST /v1/jobs/" + id + "/cancel HTTP/1.1\r\nHost: localhost:8080\r\nOrigin: " + origin +
                     "\r\n\r\n");
  };
  for (const char* origin : {"http://example.com", "null", "http://localhost:9090", "localhost:8080"})
    EXPECT_EQ(cancel_from(origin), 403) << origin;
  EXPECT_EQ(job(id).state, api::JobState::queued);
  EXPECT_EQ(status_of("DELETE /v1/jobs/" + id +
                      " HTTP/1.1\r\nHost: localhost\r\nOrigin: http://example.com\r\n\r\n"),
            403);
  const std::string body = upload_body("v 0 0 0");
  const std::string length = "Content-Length: " + std::to_string(body.size()) + "\r\n";
  EXPECT_EQ(status_of(upload_head("Origin: http://example.com\r\n" + length) + body), 403);
  EXPECT_EQ(jobs_->list(std::nullopt, std::nullopt, 10)->jobs.size(), 1u);
  EXPECT_EQ(status_of("GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\nOrigin: http://example.com\r\n\r\n"), 200)
      << "its browser keeps the answer from it";
  EXPECT_EQ(cancel_from("http://localhost:8080"), 202);
}

TEST_F(SocketTest, ATakenPortIsNotShared) {
  Router router;
  HttpRules rules;
  rules.port = http_->port();
  HttpServer second(router, *jobs_, *folder_, rules);
  const api::Status bound = second.bind();
  ASSERT_FALSE(bound);
  EXPECT_NE(bound.error().message.find(std::to_string(rules.port)), std::string::npos);
}

TEST_F(SocketTest, FilesOfAJobAreSentWholeInPartsAndNotAtAll) {
  const Job submitted = submit();
  const Claim claimed = claim();
  const std::string content(200'000, 'r');
  write_text(jobs_->folder_of(submitted) / "artefacts/patches.npz", content);
  Results results;
  results.artefacts = {{"patches.npz", "application/zip", 200'000, std::string(64, 'a')}};
  for (api::FrameIndex frame = 0; frame < 3; ++frame)
    results.key_frames.frames.push_back({frame, api::FrameKind::key, 0.0});
  ASSERT_TRUE(store_->succeed(claimed.lease, results, ""));
  const std::string request = "GET /v1/jobs/" + submitted.id + "/patches.npz HTTP/1.1\r\nHost: localhost\r\n";
  const std::string whole = ask(request + "\r\n");
  EXPECT_TRUE(whole.ends_with(content)) << whole.size();
  EXPECT_NE(whole.find("ETag: \"" + std::string(64, 'a') + "\""), std::string::npos);
  const std::string part = ask(request + "Range: bytes=100000-100004\r\n\r\n");
  EXPECT_TRUE(part.starts_with("HTTP/1.1 206") && part.ends_with("\r\n\r\nrrrrr")) << part.substr(0, 400);
  EXPECT_NE(part.find("Content-Range: bytes 100000-100004/200000"), std::string::npos);
  EXPECT_TRUE(
      ask(request + "If-None-Match: \"" + std::string(64, 'a') + "\"\r\n\r\n").starts_with("HTTP/1.1 304"));
  EXPECT_TRUE(ask("GET /v1/jobs/" + submitted.id + "/radiosity.npy HTTP/1.1\r\nHost: localhost\r\n\r\n")
                  .starts_with("HTTP/1.1 404"));
}

}  // namespace
}  // namespace server
