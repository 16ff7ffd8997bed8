#include "engine/bench/child_process.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

class ChildProcess : public testing::Test {
 protected:
  api::Status run(const char* command) {
    return run_child({"/bin/sh", "-c", command}, folder_.path() / "log");
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

TEST_F(ChildProcess, ThatCannotBeStartedIsAFailure) {
  EXPECT_FALSE(run_child({"/no/such/program"}, folder_.path() / "log"));
}

}  // namespace
}  // namespace engine
