#include "engine/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace engine {
namespace {

TEST(ParallelFor, CallsEveryNumberOnce) {
  std::vector<std::atomic<int>> calls(10'000);
  parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; });
  for (const auto& count : calls) ASSERT_EQ(count, 1);
}

TEST(ParallelFor, NothingToDoCallsNothing) {
  parallel_for(0, [](std::size_t) { FAIL(); });
}

TEST(ParallelFor, AnExceptionReachesTheCaller) {
  EXPECT_THROW(parallel_for(100,
                            [](std::size_t i) {
                              if (i == 57) throw std::runtime_error("57");
                            }),
               std::runtime_error);
}

TEST(SetThreadCount, OneThreadRunsEverythingInTheCallersThread) {
  set_thread_count(1);
  std::atomic<int> elsewhere = 0;
  const auto caller = std::this_thread::get_id();
  parallel_for(200, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::microseconds(50));  // others would have the time to join
    if (std::this_thread::get_id() != caller) ++elsewhere;
  });
  set_thread_count(0);
  EXPECT_EQ(elsewhere, 0);
}

}  // namespace
}  // namespace engine
