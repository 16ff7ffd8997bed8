// The service behind a real socket, and clients that say what the test wants.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "server/http/http_server.h"
#include "server/http/routes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {

inline constexpr std::int64_t kUploadBytesMax = 100'000;

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

  /// All that comes until the server closes.
  std::string everything() {
    std::string text;
    std::array<char, 4096> piece{};
    for (ssize_t count = 0; (count = ::recv(socket_.get(), piece.data(), piece.size(), 0)) > 0;)
      text.append(piece.data(), static_cast<std::size_t>(count));
    return text;
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
    http_rules_.upload_bytes_max = kUploadBytesMax;
    limits_.total_bytes = kUploadBytesMax;
    start();
  }
  void TearDown() override { stop(); }

  void start() {
    add_upload_routes(router_, *jobs_, *folder_, limits_);
    router_.add("PUT", "/echo", [](const HttpRequest& request, const PathValues&) {
      HttpAnswer answer;
      answer.content_type = "text/plain";
      answer.body =
          request.path + " " + std::to_string(request.body.size()) + " " + request.body.substr(0, 9);
      return answer;
    });
    router_.add("GET", "/count", [](const HttpRequest&, const PathValues&) {
      HttpAnswer answer;
      answer.content_type = "text/plain";
      answer.stream = [at = 0](std::string& piece) mutable {
        if (at % 2 == 0) piece = std::to_string(at);
        return ++at < 6;
      };
      return answer;
    });
    tokens_ = std::make_unique<TokenFolder>(temporary_.path() / "data");
    gate_ = std::make_unique<Gate>(*tokens_, gate_rules_, [this] { return now_ms_.load(); });
    http_ = std::make_unique<HttpServer>(router_, *gate_, http_rules_);
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

  UploadLimits limits_;
  GateRules gate_rules_;
  HttpRules http_rules_;
  std::unique_ptr<TokenFolder> tokens_;
  std::unique_ptr<Gate> gate_;
  Router router_;
  std::unique_ptr<HttpServer> http_;
  std::thread listener_;
};

}  // namespace server
