// Connections that wait for their request hold no thread, and do not wait without end.
#include "server/http/lobby.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <atomic>
#include <thread>
#include <vector>

namespace server {
namespace {

using std::chrono::milliseconds;

/// A client and its end of the connection.
struct Client {
  Client() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
    own = FileHandle(ends[0]);
    theirs = FileHandle(ends[1]);
    const timeval patience{5, 0};
    ::setsockopt(own.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  void say(std::string_view text) { EXPECT_EQ(::send(own.get(), text.data(), text.size(), 0), text.size()); }
  /// All that comes until the other side closes.
  std::string hear() {
    std::string heard;
    char piece[256];
    for (ssize_t count = 0; (count = ::recv(own.get(), piece, sizeof piece, 0)) > 0;)
      heard.append(piece, static_cast<std::size_t>(count));
    return heard;
  }
  FileHandle own, theirs;
};

class LobbyTest : public testing::Test {
 protected:
  void start() {
    rules_.too_slow = "too slow";
    rules_.too_many = "too many";
    lobby_ = std::make_unique<Lobby>(rules_, [this](Guest guest) {
      (void)::recv(guest.socket.get(), taken_, sizeof taken_, MSG_DONTWAIT);
      ++ready_;
    });
    ASSERT_TRUE(lobby_->start());
  }
  void enter(Client& client, std::string unread = {}) {
    lobby_->enter({std::move(client.theirs), "test", 1, std::move(unread)});
  }
  bool becomes_ready(int count, milliseconds patience = milliseconds(3000)) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (ready_ < count && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(milliseconds(5));
    return ready_ == count;
  }

  LobbyRules rules_;
  char taken_[4096] = {};
  std::atomic<int> ready_ = 0;
  std::unique_ptr<Lobby> lobby_;
};

TEST_F(LobbyTest, AGuestIsReadyOnceItsHeadIsThereWhateverCameBeforeItEntered) {
  start();
  Client early, late;
  early.say("GET / HTTP/1.1\r\n\r\n");
  enter(early);
  EXPECT_TRUE(becomes_ready(1));
  enter(late);
  for (const char* part : {"GET / HT", "TP/1.1\r", "\nHost: x\r\n", "\r"}) {
    late.say(part);
    std::this_thread::sleep_for(milliseconds(30));
    EXPECT_EQ(ready_, 1) << part;
  }
  late.say("\n");
  EXPECT_TRUE(becomes_ready(2));
  EXPECT_EQ(lobby_->guests(), 0u);
}

TEST_F(LobbyTest, WhatCameBehindTheLastRequestCounts) {
  start();
  Client client;
  enter(client, "GET / HTTP/1.1\r\nHost:");
  EXPECT_FALSE(becomes_ready(1, milliseconds(100)));
  client.say(" x\r\n\r\n");
  EXPECT_TRUE(becomes_ready(1));
}

TEST_F(LobbyTest, HeadsThatNobodyShouldWaitForAreHandedOn) {
  rules_.head_bytes_max = 1000;
  start();
  Client wrong_line, too_long, cut_off;
  for (Client* client : {&wrong_line, &too_long, &cut_off}) enter(*client);
  wrong_line.say("GET / HTTP/1.1\n");
  EXPECT_TRUE(becomes_ready(1));
  too_long.say(std::string(1000, 'x'));
  EXPECT_TRUE(becomes_ready(2));
  cut_off.say("GET / HTTP/1.1\r\n");
  ::shutdown(cut_off.own.get(), SHUT_WR);
  EXPECT_TRUE(becomes_ready(3));
}

TEST_F(LobbyTest, WhoDribblesIsToldSoAndWhoSaysNothingIsLeft) {
  rules_.idle = milliseconds(300);
  rules_.head = milliseconds(600);
  start();
  Client dribbling, silent;
  enter(dribbling);
  enter(silent);
  for (int i = 0; i < 8; ++i) {
    dribbling.say("a");
    std::this_thread::sleep_for(milliseconds(50));
  }
  EXPECT_EQ(dribbling.hear(), "too slow");
  EXPECT_EQ(silent.hear(), "");
  EXPECT_EQ(ready_, 0);
}

TEST_F(LobbyTest, WhoHasSaidAllInTimeIsHandedOnHoweverLateWeLook) {
  // More at once than are looked at in one go, and time passes before the others are.
  constexpr int kClients = 150;
  rules_.idle = milliseconds(200);
  std::atomic<bool> first = true;
  lobby_ = std::make_unique<Lobby>(rules_, [&](const Guest&) {
    if (first.exchange(false)) std::this_thread::sleep_for(2 * rules_.idle);
    ++ready_;
  });
  ASSERT_TRUE(lobby_->start());
  std::vector<Client> clients(kClients);
  for (Client& client : clients) {
    client.say("GET / HTTP/1.1\r\n\r\n");
    enter(client);
  }
  EXPECT_TRUE(becomes_ready(kClients)) << ready_;
}

TEST_F(LobbyTest, WhereThereAreTooManyTheOneThatHasBeenThereLongestGoes) {
  rules_.guests_max = 2;
  start();
  Client first, second, third;
  for (Client* client : {&first, &second, &third}) enter(*client);
  EXPECT_EQ(first.hear(), "too many");
  EXPECT_EQ(lobby_->guests(), 2u);
  third.say("GET / HTTP/1.1\r\n\r\n");
  EXPECT_TRUE(becomes_ready(1));
}

TEST_F(LobbyTest, AClosedLobbySendsEverybodyAway) {
  start();
  Client waiting, late;
  enter(waiting);
  lobby_->stop();
  EXPECT_EQ(waiting.hear(), "");
  enter(late);
  EXPECT_EQ(late.hear(), "");
  EXPECT_EQ(ready_, 0);
}

TEST(Heads, EndWithAnEmptyLine) {
  for (const char* whole :
       {"GET / HTTP/1.1\r\n\r\n", "\r\nGET / HTTP/1.1\r\nA: b\r\n\r\nbody", "GET /\n", "\n"})
    EXPECT_TRUE(is_head_here(whole)) << whole;
  for (const char* part : {"", "\r\n", "\r\n\r\n", "GET / HTTP/1.1\r\nA: b\r\n", "GET / HTTP/1.1\r\n\r"})
    EXPECT_FALSE(is_head_here(part)) << part;
}

}  // namespace
}  // namespace server
