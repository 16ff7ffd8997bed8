// The service over a real socket, with bytes that no decent client sends.
#include "tests/unit/server/socket_fixture.h"

namespace server {
namespace {

TEST_F(SocketTest, AnUploadBecomesAJobWithItsLengthKnownOrInChunks) {
  const std::string body = upload_body("v 0 0 0");
  EXPECT_EQ(status_of(upload_head("Content-Length: " + std::to_string(body.size()) + "\r\n") + body), 202);
  EXPECT_EQ(status_of(upload_head("Transfer-Encoding: chunked\r\n") + chunked(body, 7)), 202);
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 2u);
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
  http_rules_.upload_bytes_max = limits_.total_bytes = 2'000'000'000;
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
      "GET /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: many\r\n\r\n",
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
  stop();
  gate_rules_.hosts = {false, {"render.example"}};
  start();
  for (const auto& [host, status] :
       {std::pair{"render.example", 200}, {"192.168.1.1:80", 200}, {"rebound.example", 421}})
    EXPECT_EQ(status_of(std::string("GET /healthz HTTP/1.1\r\nHost: ") + host + "\r\n\r\n"), status) << host;
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
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 1u);
  EXPECT_EQ(status_of("GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\nOrigin: http://example.com\r\n\r\n"), 200)
      << "its browser keeps the answer from it";
  EXPECT_EQ(cancel_from("http://localhost:8080"), 202);
}

TEST_F(SocketTest, ATakenPortIsNotShared) {
  Router router;
  HttpRules rules;
  rules.port = http_->port();
  HttpServer second(router, *gate_, rules);
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
