#include "engine/bench/child_process.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

class ChildProcess : public testing::Test {
 protected:
  api::Result<ChildUse> run(const char* command, const ChildLimits& limits = {}) {
    return run_child({"/bin/sh", "-c", command}, folder_.path() / "log", limits);
  }
  tests::TemporaryFolder folder_;
};

TEST_F(ChildProcess, LeavesWhatItSaysInTheLog) {
  ASSERT_TRUE(run("echo out; echo err >&2; cat"));  // cat: standard input is empty, so it ends
  std::ifstream log(folder_.path() / "log");
  const std::string text{std::istreambuf_iterator<char>(log), {}};
  EXPECT_EQ(text, "out\nerr\n");
}

TEST_F(ChildProcess, FailureIsItsStatusAndItsLastWords) {
  const auto status = run("echo first; echo last; exit 3");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message, "/bin/sh ended with status 3: last");
  const auto killed = run("kill -9 $$");
  ASSERT_FALSE(killed);
  EXPECT_EQ(killed.error().message, "/bin/sh was ended by signal 9: ");
}

TEST_F(ChildProcess, ThatTakesTooLongIsStopped) {
  const auto quick = run("exit 0", {.seconds = 60});
  EXPECT_TRUE(quick);
  const auto slow = run("exec sleep 600", {.seconds = 0.1});
  ASSERT_FALSE(slow);
  EXPECT_EQ(slow.error().fault, api::Fault::out_of_resources);
}

TEST_F(ChildProcess, GetsNoMoreMemoryThanItMayHave) {
  const char* doubles =
      "x=xxxxxxxx; for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22; do x=$x$x; done";
  const auto whole = run(doubles);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_GT(whole->peak_memory_bytes, 8u << 22);
  EXPECT_GT(whole->cpu_s, 0);
  EXPECT_FALSE(run(doubles, {.memory_bytes = 4u << 20}));
}

TEST_F(ChildProcess, ThatCannotBeStartedIsAFailure) {
  EXPECT_FALSE(run_child({"/no/such/program"}, folder_.path() / "log"));
}

}  // namespace
}  // namespace engine
