// Which of the workers that are dead was killed for want of memory.
#include "server/workers/memory_kills.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using namespace std::chrono_literals;
using Why = std::vector<KilledFor>;

constexpr std::int64_t kMiB = 1 << 20;

class MemoryKillsTest : public testing::Test {
 protected:
  std::int64_t count_ = 7;  ///< of before the service began
  MemoryKills kills_{[this] { return count_; }};
  const MemoryKills::Clock::time_point now_ = MemoryKills::Clock::now();
};

TEST_F(MemoryKillsTest, AKillExplainsTheDeathOfTheLargest) {
  ++count_;
  EXPECT_EQ(kills_.judge({900 * kMiB}, 100 * kMiB), Why{KilledFor::memory});
}

TEST_F(MemoryKillsTest, WithoutAKillItWasAnotherEnd) {
  EXPECT_EQ(kills_.judge({900 * kMiB}, 0), Why{KilledFor::another_end});
}

TEST_F(MemoryKillsTest, OneKillExplainsOneDeath) {
  ++count_;
  EXPECT_EQ(kills_.judge({900 * kMiB}, 800 * kMiB), Why{KilledFor::memory});
  EXPECT_EQ(kills_.judge({800 * kMiB}, 0), Why{KilledFor::another_end}) << "killed by hand a moment later";
}

TEST_F(MemoryKillsTest, ASmallWorkerIsNotWhatTheKernelChooses) {
  ++count_;  // of the large one, whose death is not seen yet
  EXPECT_EQ(kills_.judge({100 * kMiB}, 900 * kMiB), Why{KilledFor::another_end});
  EXPECT_EQ(kills_.judge({900 * kMiB}, 0), Why{KilledFor::memory});
}

TEST_F(MemoryKillsTest, OfTwoDeathsAndOneKillNobodyKnowsWhich) {
  ++count_;
  EXPECT_EQ(kills_.judge({900 * kMiB, 850 * kMiB}, 0), (Why{KilledFor::perhaps, KilledFor::perhaps}));
  ++count_;
  EXPECT_EQ(kills_.judge({900 * kMiB, 10 * kMiB}, 300 * kMiB),
            (Why{KilledFor::memory, KilledFor::another_end}));
  count_ += 2;
  EXPECT_EQ(kills_.judge({900 * kMiB, 850 * kMiB}, 0), (Why{KilledFor::memory, KilledFor::memory}));
}

TEST_F(MemoryKillsTest, AKillOfAnotherProcessIsForgottenSoon) {
  ++count_;
  kills_.look(now_);
  kills_.look(now_ + 1s);
  EXPECT_EQ(kills_.judge({}, 0), Why{});
  kills_.look(now_ + 2s);
  EXPECT_EQ(kills_.judge({900 * kMiB}, 0), Why{KilledFor::another_end});
}

}  // namespace
}  // namespace server
