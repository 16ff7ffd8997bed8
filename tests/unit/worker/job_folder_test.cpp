#include "engine/worker/job_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <thread>

#include "tests/unit/worker/a_job_folder.h"

namespace {

using engine::JobFolder;
using namespace std::chrono_literals;

TEST(JobFolder, ASecondWorkerIsRefusedUntilTheFirstHasLeft) {
  const tests::AJobFolder folder;
  {
    const auto first = JobFolder::open(folder.path);
    ASSERT_TRUE(first) << first.error().message;
    const auto second = JobFolder::open(folder.path, 0ms);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().fault, api::Fault::wrong_state);
    EXPECT_NE(second.error().message.find("another worker"), std::string::npos);
  }
  EXPECT_TRUE(JobFolder::open(folder.path, 0ms));
}

TEST(JobFolder, AWorkerThatIsJustDyingIsWaitedFor) {
  const tests::AJobFolder folder;
  auto first = JobFolder::open(folder.path);
  ASSERT_TRUE(first);
  std::jthread leaves([held = std::optional<JobFolder>(std::move(*first))]() mutable {
    std::this_thread::sleep_for(100ms);
    held.reset();
  });
  EXPECT_TRUE(JobFolder::open(folder.path, 10s));
}

TEST(JobFolder, AFolderThatIsNotThereIsNotMade) {
  const tests::AJobFolder folder;
  const auto opened = JobFolder::open(folder.path / "nowhere");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().fault, api::Fault::not_found);
  EXPECT_FALSE(folder.has("nowhere"));
}

TEST(ClearLeftovers, RemovesTheManifestTheReportAndTemporaryFilesAndKeepsArtefacts) {
  const tests::AJobFolder folder;
  folder.write("artefacts/manifest.json", "{}");
  folder.write("artefacts/radiosity.npy", "old");
  folder.write("artefacts/.tmp.radiosity.npy", "half");
  folder.write("artefacts/images/main/.tmp.frame_0001.png", "half");
  folder.write("artefacts/images/main/frame_0000.png", "old");
  folder.write("report.json", "{}");
  folder.write("progress.ndjson", "{}\n");
  const auto opened = JobFolder::open(folder.path);
  ASSERT_TRUE(opened);
  ASSERT_TRUE(engine::clear_leftovers(*opened));
  EXPECT_FALSE(folder.has("artefacts/manifest.json"));
  EXPECT_FALSE(folder.has("report.json"));
  EXPECT_FALSE(folder.has("artefacts/.tmp.radiosity.npy"));
  EXPECT_FALSE(folder.has("artefacts/images/main/.tmp.frame_0001.png"));
  EXPECT_TRUE(folder.has("artefacts/radiosity.npy"));
  EXPECT_TRUE(folder.has("artefacts/images/main/frame_0000.png"));
  EXPECT_TRUE(folder.has("progress.ndjson"));
  EXPECT_TRUE(folder.has("input/animation.json"));
}

TEST(ClearLeftovers, MakesTheArtefactsFolderOfAFirstAttempt) {
  const tests::AJobFolder folder;
  const auto opened = JobFolder::open(folder.path);
  ASSERT_TRUE(opened);
  ASSERT_TRUE(engine::clear_leftovers(*opened));
  EXPECT_TRUE(std::filesystem::is_directory(folder.path / "artefacts"));
}

TEST(ClearLeftovers, DoesNotFollowLinksOutOfTheFolder) {
  const tests::AJobFolder folder;
  const tests::AJobFolder other;
  other.write(".tmp.precious", "keep");
  folder.write("artefacts/radiosity.npy", "old");
  std::filesystem::create_directory_symlink(other.path, folder.path / "artefacts/link");
  const auto opened = JobFolder::open(folder.path);
  ASSERT_TRUE(opened);
  ASSERT_TRUE(engine::clear_leftovers(*opened));
  EXPECT_TRUE(other.has(".tmp.precious"));
}

class ReadJobRequest : public testing::Test {
 protected:
  api::ReadRequest read() {
    const auto opened = JobFolder::open(folder_.path);
    auto read = opened ? engine::read_job_request(*opened) : opened.error();
    EXPECT_TRUE(read) << read.error().message;
    return read ? *read : api::ReadRequest{};
  }
  /// The code of the only violation.
  std::string code() {
    const api::ReadRequest refused = read();
    if (refused.violations.size() != 1) return "?";
    EXPECT_FALSE(refused.is_document);
    EXPECT_EQ(refused.violations[0].file, "animation.json");
    return refused.violations[0].code;
  }
  tests::AJobFolder folder_;
};

TEST_F(ReadJobRequest, ReadsTheAnimation) {
  EXPECT_EQ(read().request.frame_count, 2u);
  EXPECT_TRUE(read().violations.empty());
}

TEST_F(ReadJobRequest, AMissingFileIsAViolation) {
  std::filesystem::remove(folder_.path / "input/animation.json");
  EXPECT_EQ(code(), "missing_file");
}

TEST_F(ReadJobRequest, AFileOfTheLargestSizeIsReadAndOneByteMoreIsRefused) {
  std::string bytes = R"({"frames": {"count": 3}})";
  bytes.resize(api::kAnimationBytesMax, ' ');
  folder_.write("input/animation.json", bytes);
  EXPECT_EQ(read().request.frame_count, 3u);
  EXPECT_TRUE(read().violations.empty());
  folder_.write("input/animation.json", bytes + ' ');
  EXPECT_EQ(code(), "too_large");
}

TEST_F(ReadJobRequest, AHugeFileIsRefusedUnread) {
  std::filesystem::resize_file(folder_.path / "input/animation.json", std::uintmax_t{1} << 40);
  EXPECT_EQ(code(), "too_large");
}

TEST_F(ReadJobRequest, APipeInItsPlaceDoesNotHang) {
  std::filesystem::remove(folder_.path / "input/animation.json");
  ASSERT_EQ(mkfifo((folder_.path / "input/animation.json").c_str(), 0600), 0);
  EXPECT_EQ(code(), "not_a_file");
}

TEST(WriteReport, TheReportInHasteReplacesAnOldOneWhole) {
  const tests::AJobFolder folder;
  folder.write("report.json", "old");
  const auto opened = JobFolder::open(folder.path);
  ASSERT_TRUE(opened);
  api::JobReport report;
  report.outcome = "stopped";
  report.message = "told to stop";
  engine::write_report_in_haste(opened->report(), report);
  const auto read = api::parse_job_report(folder.read("report.json"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->outcome, "stopped");
  EXPECT_EQ(read->message, "told to stop");
}

}  // namespace
