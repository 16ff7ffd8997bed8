#include "engine/base/durable_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>

#include "engine/output/artefacts.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using tests::bytes_of;

class DurableFileTest : public ::testing::Test {
 protected:
  const tests::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(DurableFileTest, ReplacesWhatHadTheNameBefore) {
  ASSERT_TRUE(engine::write_file(folder_ / "a", "old and longer"));
  ASSERT_TRUE(engine::write_file(folder_ / "a", "new"));
  EXPECT_EQ(bytes_of(folder_ / "a"), "new");
}

TEST_F(DurableFileTest, LeavesNothingBehindWhenItIsNotPublished) {
  {
    auto file = engine::DurableFile::create(folder_ / "a");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->append("half"));
    EXPECT_FALSE(fs::exists(folder_ / "a"));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(DurableFileTest, AKilledProcessLeavesNoFinalNameAndTheNextOneSucceeds) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto file = engine::DurableFile::create(folder_ / "a");
    if (!file || !file->append("half")) ::_exit(1);
    (void)!::write(ready[1], "x", 1);
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  ::close(ready[0]);
  ::close(ready[1]);

  EXPECT_FALSE(fs::exists(folder_ / "a"));
  EXPECT_TRUE(fs::exists(folder_ / ".tmp.a")) << "the kill came too early to tell anything";
  ASSERT_TRUE(engine::write_file(folder_ / "a", "whole"));
  EXPECT_EQ(bytes_of(folder_ / "a"), "whole");
  EXPECT_FALSE(fs::exists(folder_ / ".tmp.a"));
}

TEST_F(DurableFileTest, DoesNotFollowALinkUnderItsTemporaryName) {
  ASSERT_TRUE(engine::write_file(folder_ / "victim", "precious"));
  fs::create_symlink(folder_ / "victim", folder_ / ".tmp.a");
  ASSERT_TRUE(engine::write_file(folder_ / "a", "mine"));
  EXPECT_EQ(bytes_of(folder_ / "victim"), "precious");
  EXPECT_FALSE(fs::is_symlink(folder_ / "a"));
}

TEST_F(DurableFileTest, NamesPathAndReasonWhenTheFolderIsMissing) {
  const auto written = engine::write_file(folder_ / "nowhere" / "a", "x");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, api::Fault::internal);
  EXPECT_NE(written.error().message.find("nowhere"), std::string::npos);
  EXPECT_NE(written.error().message.find("No such file"), std::string::npos) << written.error().message;
}

/// In a child with mounts of its own: writes 256 KiB to a disk of 64 KiB.
/// 0: as it should be, 1: not, 77: this machine does not let us mount.
int write_to_a_full_disk(const fs::path& folder) {
  if (::unshare(CLONE_NEWNS) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return 77;
  ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  if (::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") != 0) return 77;
  const auto written = engine::write_file(folder / "a", std::string(256 << 10, 'x'));
  const bool right = !written && written.error().fault == api::Fault::disk_full && fs::is_empty(folder);
  return right ? 0 : 1;
}

TEST_F(DurableFileTest, AFullDiskIsAFaultOfItsOwnAndLeavesNothing) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) ::_exit(write_to_a_full_disk(folder_));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no right to mount a small disk here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(FileError, TellsAFullDiskFromOtherTrouble) {
  EXPECT_EQ(engine::file_error("write", "a", ENOSPC).fault, api::Fault::disk_full);
  EXPECT_EQ(engine::file_error("write", "a", EDQUOT).fault, api::Fault::disk_full);
  EXPECT_EQ(engine::file_error("write", "a", EIO).fault, api::Fault::internal);
  EXPECT_EQ(engine::file_error("write", "a", EIO).message, "cannot write 'a': Input/output error");
}

}  // namespace
