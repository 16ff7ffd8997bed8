// What files of control groups say, in both versions.
#include "server/workers/control_group.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace {

using namespace server;

class ControlGroup : public ::testing::Test {
 protected:
  void write(const char* name, const char* text) {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }

  tests::TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.path();
};

TEST_F(ControlGroup, LimitsAndKillsAreReadInVersion2) {
  write("memory.max", "536870912\n");
  write("memory.events", "low 0\nhigh 0\nmax 7\noom 3\noom_kill 2\n");
  EXPECT_EQ(group_memory_limit_bytes(root_), 536870912);
  EXPECT_EQ(out_of_memory_kills(root_), 2);
}

TEST_F(ControlGroup, LimitsAndKillsAreReadInVersion1) {
  write("memory/memory.limit_in_bytes", "536870912\n");
  write("memory/memory.oom_control", "oom_kill_disable 0\nunder_oom 0\noom_kill 5\n");
  EXPECT_EQ(group_memory_limit_bytes(root_), 536870912);
  EXPECT_EQ(out_of_memory_kills(root_), 5);
}

TEST_F(ControlGroup, WithoutALimitThereIsNone) {
  write("memory.max", "max\n");
  EXPECT_EQ(group_memory_limit_bytes(root_), std::nullopt);
  write("memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(group_memory_limit_bytes(root_), std::nullopt);
}

TEST_F(ControlGroup, CoresAreReadInVersion2AndRoundedUp) {
  write("cpu.max", "150000 100000\n");
  EXPECT_EQ(group_core_limit(root_), 2u);
  write("cpu.max", "400000 100000\n");
  EXPECT_EQ(group_core_limit(root_), 4u);
  write("cpu.max", "1000 100000\n");
  EXPECT_EQ(group_core_limit(root_), 1u);
}

TEST_F(ControlGroup, CoresAreReadInVersion1) {
  write("cpu/cpu.cfs_quota_us", "250000\n");
  write("cpu/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(group_core_limit(root_), 3u);
}

TEST_F(ControlGroup, WithoutALimitOfCoresThereIsNone) {
  EXPECT_EQ(group_core_limit(root_), std::nullopt);
  write("cpu.max", "max 100000\n");
  EXPECT_EQ(group_core_limit(root_), std::nullopt);
  write("cpu/cpu.cfs_quota_us", "-1\n");
  write("cpu/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(group_core_limit(root_), std::nullopt);
}

TEST_F(ControlGroup, WhereNobodySaysThereIsNoLimitAndNoKill) {
  EXPECT_EQ(group_memory_limit_bytes(root_), std::nullopt);
  EXPECT_EQ(out_of_memory_kills(root_), 0);
}

}  // namespace
