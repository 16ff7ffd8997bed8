#include "engine/worker/progress_file.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/unit/worker/a_job_folder.h"

namespace {

using api::Stage;
using engine::ProgressFile;
using namespace std::chrono_literals;

constexpr engine::ProgressPace kUnpaced{.apart = 0ms, .heartbeat = 1h};

class Progress : public testing::Test {
 protected:
  std::unique_ptr<ProgressFile> open(engine::ProgressPace pace) {
    auto file = ProgressFile::open(path(), pace);
    EXPECT_TRUE(file) << file.error().message;
    return file ? std::move(*file) : nullptr;
  }
  std::filesystem::path path() const { return folder_.path / "progress.ndjson"; }

  /// Every line, each of which must be whole.
  std::vector<api::ProgressLine> lines() const {
    const std::string text = folder_.read("progress.ndjson");
    EXPECT_TRUE(text.empty() || text.back() == '\n');
    std::vector<api::ProgressLine> parsed;
    for (const std::string& line : tests::lines_of(text)) {
      const auto progress = api::parse_progress_line(line);
      EXPECT_TRUE(progress) << line;
      if (progress) parsed.push_back(*progress);
    }
    return parsed;
  }

  tests::AJobFolder folder_;
};

TEST_F(Progress, LinesComeBackAsTheyWereReported) {
  open(kUnpaced)->report({Stage::solve, 0.25, 0.5, "line 7 \"quoted\"\nand more"});
  ASSERT_EQ(lines().size(), 1u);
  EXPECT_EQ(lines()[0].stage, Stage::solve);
  EXPECT_EQ(lines()[0].stage_fraction, 0.25);
  EXPECT_EQ(lines()[0].fraction, 0.5);
  EXPECT_EQ(lines()[0].message, "line 7 \"quoted\"\nand more");
}

TEST_F(Progress, FractionsStayBetweenZeroAndOneAndTheJobsNeverFalls) {
  {
    const auto file = open(kUnpaced);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double fraction : {-1.0, 0.5, 0.25, nan, 7.0})
      file->report({Stage::solve, fraction, fraction, ""});
  }
  std::vector<double> job, stage;
  for (const auto& line : lines()) {
    job.push_back(line.fraction);
    stage.push_back(line.stage_fraction);
  }
  EXPECT_EQ(job, (std::vector<double>{0, 0.5, 0.5, 0.5, 1}));
  EXPECT_EQ(stage, (std::vector<double>{0, 0.5, 0.25, 0, 1}));
}

// 300 reports, 1 ms apart, with lines at least 100 ms apart: the time taken allows so many lines, and one
// more for the first and one for the last.
TEST_F(Progress, ABusyStageWritesNoMoreThanItsPaceAllows) {
  const auto start = std::chrono::steady_clock::now();
  {
    const auto file = open({.apart = 100ms, .heartbeat = 1h});
    for (int i = 1; i <= 300; ++i) {
      file->report({Stage::solve, i / 300.0, i / 300.0, ""});
      std::this_thread::sleep_for(1ms);
    }
  }
  const auto allowed = (std::chrono::steady_clock::now() - start) / 100ms + 2;
  EXPECT_LE(static_cast<long>(lines().size()), allowed);
  EXPECT_GE(lines().size(), 3u);
  EXPECT_EQ(lines().back().fraction, 1.0) << "the newest is written when the file is closed";
}

TEST_F(Progress, TheNewestOfManyIsWrittenWhenItsTimeHasCome) {
  const auto file = open({.apart = 20ms, .heartbeat = 1h});
  file->report({Stage::solve, 0.1, 0.1, ""});
  file->report({Stage::solve, 0.2, 0.2, ""});
  file->report({Stage::solve, 0.3, 0.3, ""});
  for (int i = 0; i < 500 && lines().size() < 2; ++i) std::this_thread::sleep_for(10ms);
  ASSERT_GE(lines().size(), 2u);
  EXPECT_EQ(lines().back().fraction, 0.3);
}

TEST_F(Progress, ANewStageIsWrittenAtOnce) {
  const auto file = open({.apart = 1h, .heartbeat = 2h});
  for (const Stage stage : {Stage::scene, Stage::patches, Stage::direct, Stage::estimate})
    file->report({stage, 0, 0, ""});
  EXPECT_EQ(lines().size(), 4u);
}

TEST_F(Progress, AHeartbeatRepeatsTheNewestLineWhileAStageIsSilent) {
  const auto file = open({.apart = 1ms, .heartbeat = 20ms});
  file->report({Stage::solve, 0.5, 0.5, "silent now"});
  for (int i = 0; i < 500 && lines().size() < 4; ++i) std::this_thread::sleep_for(10ms);
  ASSERT_GE(lines().size(), 4u);
  for (const auto& line : lines()) EXPECT_EQ(line.message, "silent now");
}

TEST_F(Progress, NothingIsWrittenBeforeTheFirstReport) {
  const auto file = open({.apart = 1ms, .heartbeat = 5ms});
  std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(lines().empty());
}

TEST_F(Progress, LinesFromManyThreadsAreWhole) {
  {
    const auto file = open(kUnpaced);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 200; ++i) file->report({Stage::solve, 0.5, 0.5, std::string(300, 'x')});
      });
  }
  EXPECT_EQ(lines().size(), 800u);
}

TEST_F(Progress, ALineCutOffByACrashDoesNotSpoilTheNext) {
  folder_.write("progress.ndjson", "{\"stage\":\"sol");
  open(kUnpaced)->report({Stage::scene, 0, 0, ""});
  const auto all = tests::lines_of(folder_.read("progress.ndjson"));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0], "{\"stage\":\"sol");
  EXPECT_TRUE(api::parse_progress_line(all[1])) << all[1];
}

TEST_F(Progress, ALaterAttemptAppends) {
  open(kUnpaced)->report({Stage::solve, 0.5, 0.9, ""});
  open(kUnpaced)->report({Stage::scene, 0, 0, ""});
  ASSERT_EQ(lines().size(), 2u);
  EXPECT_EQ(lines()[1].fraction, 0.0) << "a new attempt begins at nothing";
}

TEST_F(Progress, AFileThatCannotBeOpenedIsAnErrorThatNamesIt) {
  const auto file = ProgressFile::open(folder_.path / "nowhere" / "progress.ndjson");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("nowhere"), std::string::npos);
}

}  // namespace
