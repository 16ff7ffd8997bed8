// Small bodies in, streamed answers out, over a real socket.
#include "tests/unit/server/socket_fixture.h"

namespace server {
namespace {

TEST_F(SocketTest, ASmallBodyReachesItsHandlerWhole) {
  const std::string head = "PUT /echo HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n";
  const auto with_length = [&](const std::string& more, const std::string& body) {
    return ask(head + more + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  };
  EXPECT_TRUE(with_length("", "{\"a\":1}").ends_with("\r\n\r\n/echo 7 {\"a\":1}"));
  EXPECT_TRUE(
      with_length("Content-Type: multipart/form-data; boundary=x\r\n", "--x\r\nno").ends_with("7 --x\r\nno"));
  EXPECT_TRUE(with_length("Content-Type: application/x-www-form-urlencoded\r\n", std::string(9000, 'a'))
                  .ends_with("9000 aaaaaaaaa"));
  EXPECT_TRUE(ask(head + "Transfer-Encoding: chunked\r\n\r\n" + chunked("hello, world", 5))
                  .ends_with("12 hello, wo"));
  EXPECT_TRUE(ask(head + "\r\n").ends_with("\r\n\r\n/echo 0 ")) << "none at all";
  EXPECT_TRUE(with_length("", std::string(1 << 20, 'b')).ends_with("/echo 1048576 bbbbbbbbb"));
}

TEST_F(SocketTest, ASmallBodyThatIsTooLargePackedOrCutOffIsRefused) {
  const std::string head = "PUT /echo HTTP/1.1\r\nHost: localhost\r\n";
  const std::string large((1 << 20) + 1, 'b');
  EXPECT_EQ(status_of(head + "Content-Length: 1048577\r\n\r\n" + large), 413);
  EXPECT_EQ(status_of(head + "Transfer-Encoding: chunked\r\n\r\n" + chunked(large, 50'000)), 413);
  EXPECT_EQ(status_of(head + "Expect: 100-continue\r\nContent-Length: 1048577\r\n\r\n"), 413);
  EXPECT_EQ(status_of(head + "Content-Encoding: gzip\r\nContent-Length: 5\r\n\r\nhello"), 415);
  EXPECT_EQ(status_of("GET /count HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello"), 413);
  Connection connection(http_->port());
  connection.say(head + "Content-Length: 100\r\n\r\nhello");
  connection.say_no_more();
  EXPECT_EQ(connection.status(), 400);
}

TEST_F(SocketTest, AStreamedAnswerComesInChunksAndEndsWhereItsSourceDoes) {
  const std::string text = ask("GET /count HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_NE(text.find("Transfer-Encoding: chunked"), std::string::npos) << text;
  Connection connection(http_->port());
  connection.say("GET /count HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  const std::string whole = connection.everything();
  EXPECT_TRUE(whole.ends_with("\r\n\r\n1\r\n0\r\n1\r\n2\r\n1\r\n4\r\n0\r\n\r\n")) << whole;
}

}  // namespace
}  // namespace server
