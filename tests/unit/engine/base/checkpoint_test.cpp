#include "engine/base/checkpoint.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/rgb.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using tests::bytes_of;

struct Header {
  std::uint32_t replicate = 0;
  double spread = 0;
};

class CheckpointTest : public ::testing::Test {
 protected:
  const tests::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path() / "checkpoint";
  const Header header_{7, 0.25};
  const std::vector<Rgb> light_{{1, 2, 3}, {4, 5, 6}};
  const std::string words_ = "words";

  Checkpoints checkpoints(const std::string& fingerprint = "job") { return {folder_, fingerprint}; }
  void save_sample() {
    auto all = checkpoints();
    ASSERT_TRUE(all.save(
        "solve", {part_of_checkpoint(header_), part_of_checkpoint(light_), part_of_checkpoint(words_)}));
  }
  /// Writes `bytes` over the sample's file, loads it, and expects nothing, neither in memory nor on disk.
  void expect_refused(const std::string& bytes, const std::string& what) {
    std::ofstream(folder_ / "solve", std::ios::binary) << bytes;
    EXPECT_FALSE(checkpoints().load("solve")) << what;
    EXPECT_FALSE(fs::exists(folder_ / "solve")) << what;
  }
};

TEST_F(CheckpointTest, GivesBackItsPartsInOrder) {
  save_sample();
  auto saved = checkpoints().load("solve");
  ASSERT_TRUE(saved);
  EXPECT_EQ(saved->parts_left(), 3u);
  Header header;
  std::vector<Rgb> light;
  std::string words;
  ASSERT_TRUE(saved->take(header) && saved->take(light) && saved->take(words));
  EXPECT_EQ(header.replicate, header_.replicate);
  EXPECT_EQ(header.spread, header_.spread);
  EXPECT_EQ(light, light_);
  EXPECT_EQ(words, words_);
  EXPECT_FALSE(saved->take(words)) << "there is no more";
}

TEST_F(CheckpointTest, APartOfAnotherSizeIsNotTaken) {
  save_sample();
  auto saved = checkpoints().load("solve");
  ASSERT_TRUE(saved);
  std::uint32_t too_small = 0;
  std::vector<Rgb> of_twelve_bytes;
  EXPECT_FALSE(saved->take(too_small));
  EXPECT_FALSE(saved->take(of_twelve_bytes)) << "16 bytes are no whole number of them";
  Header header;
  EXPECT_TRUE(saved->take(header)) << "and is still there";
}

TEST_F(CheckpointTest, AnEmptyVectorIsAPartToo) {
  auto all = checkpoints();
  const std::vector<float> none;
  ASSERT_TRUE(all.save("solve", {part_of_checkpoint(none), part_of_checkpoint(words_)}));
  auto saved = all.load("solve");
  ASSERT_TRUE(saved);
  std::vector<float> taken(5);
  std::string words;
  ASSERT_TRUE(saved->take(taken) && saved->take(words));
  EXPECT_TRUE(taken.empty());
  EXPECT_EQ(words, words_);
}

TEST_F(CheckpointTest, ALaterOneReplacesTheEarlierAndLeavesNoOtherFile) {
  save_sample();
  auto all = checkpoints();
  ASSERT_TRUE(all.save("solve", {part_of_checkpoint(words_)}));
  auto saved = all.load("solve");
  ASSERT_TRUE(saved);
  EXPECT_EQ(saved->parts_left(), 1u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(CheckpointTest, OfAnotherJobItIsRemoved) {
  save_sample();
  EXPECT_FALSE(checkpoints("another job").load("solve"));
  EXPECT_FALSE(fs::exists(folder_ / "solve"));
}

TEST_F(CheckpointTest, AnyByteThatIsWrongMakesItNothing) {
  save_sample();
  const std::string whole = bytes_of(folder_ / "solve");
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    expect_refused(damaged, "byte " + std::to_string(at));
  }
}

TEST_F(CheckpointTest, CutAnywhereOrWithMoreBehindItIsNothing) {
  save_sample();
  const std::string whole = bytes_of(folder_ / "solve");
  for (std::size_t size = 0; size < whole.size(); ++size)
    expect_refused(whole.substr(0, size), "cut after " + std::to_string(size));
  expect_refused(whole + "x", "one byte more");
}

TEST_F(CheckpointTest, ALinkInItsPlaceIsNotFollowed) {
  save_sample();
  fs::rename(folder_ / "solve", temporary_.path() / "elsewhere");
  fs::create_symlink(temporary_.path() / "elsewhere", folder_ / "solve");
  EXPECT_FALSE(checkpoints().load("solve"));
}

TEST_F(CheckpointTest, WithoutAFolderNothingIsKeptNorDue) {
  Checkpoints none;
  EXPECT_TRUE(none.save("solve", {part_of_checkpoint(words_)}));
  EXPECT_FALSE(none.load("solve"));
  EXPECT_FALSE(none.due());
  none.remove("solve");
  none.clear();
}

TEST_F(CheckpointTest, IsDueOnceTheTimeSinceTheLastSaveHasPassed) {
  Checkpoints all(folder_, "job", 200ms);
  EXPECT_FALSE(all.due());
  std::this_thread::sleep_for(250ms);
  EXPECT_TRUE(all.due());
  ASSERT_TRUE(all.save("solve", {}));
  EXPECT_FALSE(all.due());
}

TEST_F(CheckpointTest, ClearingRemovesTheFolder) {
  save_sample();
  auto all = checkpoints();
  ASSERT_TRUE(all.save("other", {}));
  all.remove("other");
  EXPECT_FALSE(all.load("other"));
  EXPECT_TRUE(all.load("solve"));
  all.clear();
  EXPECT_FALSE(fs::exists(folder_));
}

/// In a child with mounts of its own, on a disk of 64 KiB. 0: as it should be, 77: we may not mount here.
int save_on_a_full_disk(const fs::path& folder) {
  if (::unshare(CLONE_NEWNS) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return 77;
  ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
  if (::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") != 0) return 77;
  Checkpoints all(folder / "checkpoint", "job");
  const std::string fits(1 << 10, 'x'), does_not(256 << 10, 'x');
  if (!all.save("solve", {part_of_checkpoint(fits)})) return 1;
  const auto refused = all.save("solve", {part_of_checkpoint(does_not)});
  if (refused || refused.error().fault != api::Fault::disk_full) return 2;
  auto earlier = all.load("solve");
  std::string taken;
  if (!earlier || !earlier->take(taken) || taken != fits) return 3;
  const auto files = std::distance(fs::directory_iterator(folder / "checkpoint"), fs::directory_iterator());
  return files == 1 ? 0 : 4;
}

TEST_F(CheckpointTest, OnAFullDiskTheEarlierOneStands) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) ::_exit(save_on_a_full_disk(temporary_.path()));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no right to mount a small disk here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace engine
