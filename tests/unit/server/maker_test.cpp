// What is made on request: once, in line, and ended with the server.
#include "server/workers/maker.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace server {
namespace {

using namespace std::chrono_literals;

/// False: not within 5 s.
template <class Condition>
bool wait_until(Condition condition) {
  for (int k = 0; k < 500 && !condition(); ++k) std::this_thread::sleep_for(10ms);
  return condition();
}

Maker::Work until(const std::atomic<bool>& go, std::atomic<int>& count) {
  return [&](const std::atomic<bool>& stopping) -> api::Status {
    ++count;
    while (!go && !stopping) std::this_thread::sleep_for(1ms);
    if (stopping) return api::Error{api::Fault::stopped, ""};
    return api::Done{};
  };
}

TEST(Maker, MakesWhatIsAskedForTwiceOnce) {
  std::atomic<bool> go = false;
  std::atomic<int> count = 0;
  Maker maker(2, 10);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(maker.ask("a", until(go, count)));
  ASSERT_TRUE(wait_until([&] { return maker.look("a").state == Maker::State::making; }));
  EXPECT_FALSE(maker.forget("a")) << "it is being made";
  go = true;
  ASSERT_TRUE(wait_until([&] { return maker.look("a").state == Maker::State::unknown; }));
  EXPECT_EQ(count, 1);
}

TEST(Maker, MakesNoMoreAtOnceAndLetsNoMoreWaitThanItMay) {
  std::atomic<bool> go = false;
  std::atomic<int> count = 0;
  Maker maker(1, 2);
  ASSERT_TRUE(maker.ask("a", until(go, count)));
  ASSERT_TRUE(wait_until([&] { return maker.look("a").state == Maker::State::making; }));
  ASSERT_TRUE(maker.ask("b", until(go, count)));
  ASSERT_TRUE(maker.ask("c", until(go, count)));
  const api::Status full = maker.ask("d", until(go, count));
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().fault, api::Fault::out_of_resources);
  EXPECT_EQ(maker.look("d").state, Maker::State::unknown);
  EXPECT_EQ(maker.look("b").state, Maker::State::waiting);
  EXPECT_EQ(count, 1);
  EXPECT_TRUE(maker.forget("b"));
  go = true;
  ASSERT_TRUE(wait_until([&] { return maker.look("c").state == Maker::State::unknown; }));
  EXPECT_EQ(count, 2) << "b was forgotten";
}

TEST(Maker, RemembersWhyItFailedAndTriesAgainWhenAsked) {
  std::atomic<int> count = 0;
  const Maker::Work fail = [&](const std::atomic<bool>&) -> api::Status {
    ++count;
    return api::Error{api::Fault::internal, "no luck"};
  };
  Maker maker(1, 2);
  ASSERT_TRUE(maker.ask("a", fail));
  ASSERT_TRUE(wait_until([&] { return maker.look("a").state == Maker::State::failed; }));
  EXPECT_EQ(maker.look("a").error.message, "no luck");
  ASSERT_TRUE(maker.ask("a", fail));
  ASSERT_TRUE(wait_until([&] { return count == 2 && maker.look("a").state == Maker::State::failed; }));
  EXPECT_TRUE(maker.forget("a"));
  EXPECT_EQ(maker.look("a").state, Maker::State::unknown);
}

TEST(Maker, WhatFoundNoRoomWaitsAndIsTriedAgain) {
  std::atomic<bool> room = false;
  std::atomic<int> count = 0, others = 0;
  Maker maker(1, 5, 20ms);
  ASSERT_TRUE(maker.ask("a", [&](const std::atomic<bool>&) -> api::Status {
    ++count;
    if (!room) return api::Error{api::Fault::disk_full, "no room"};
    return api::Done{};
  }));
  ASSERT_TRUE(wait_until([&] { return count >= 3; })) << "nobody had to ask again";
  ASSERT_TRUE(wait_until([&] {
    const Maker::Look look = maker.look("a");
    return look.state == Maker::State::waiting && look.error.message == "no room";
  }));
  const std::atomic<bool> go = true;
  ASSERT_TRUE(maker.ask("b", until(go, others)));
  ASSERT_TRUE(wait_until([&] { return others == 1; })) << "others do not wait for it";
  room = true;
  ASSERT_TRUE(wait_until([&] { return maker.look("a").state == Maker::State::unknown; }));
}

TEST(Maker, EndsAllOfOneKindAndNothingElse) {
  std::atomic<bool> go = false;
  std::atomic<int> ours = 0, others = 0;
  Maker maker(1, 5);
  ASSERT_TRUE(maker.ask("job/1", until(go, ours)));
  ASSERT_TRUE(wait_until([&] { return ours == 1; }));
  ASSERT_TRUE(maker.ask("job/2", until(go, ours)));
  ASSERT_TRUE(maker.ask("other/1", until(go, others)));
  maker.end_all("job/");
  EXPECT_EQ(maker.look("job/1").state, Maker::State::unknown);
  EXPECT_EQ(maker.look("job/2").state, Maker::State::unknown);
  EXPECT_EQ(ours, 1) << "the second was never begun";
  go = true;
  ASSERT_TRUE(
      wait_until([&] { return others == 1 && maker.look("other/1").state == Maker::State::unknown; }));
  go = false;
  ASSERT_TRUE(maker.ask("job/1", until(go, ours))) << "it can be asked for again";
  ASSERT_TRUE(wait_until([&] { return ours == 2; }));
}

TEST(Maker, StoppingEndsWhatIsBeingMadeAndForgetsWhatWaits) {
  std::atomic<bool> never = false;
  std::atomic<int> count = 0;
  Maker maker(1, 5);
  for (const char* key : {"a", "b", "c"}) ASSERT_TRUE(maker.ask(key, until(never, count)));
  ASSERT_TRUE(wait_until([&] { return count == 1; }));
  maker.stop();
  EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace server
