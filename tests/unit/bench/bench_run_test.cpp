// Jobs are run as often as needed and no more. The program is a script that counts.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_plan.h"
#include "engine/bench/bench_runner.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

const std::filesystem::path kExamples = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples";

/// Called as `PROGRAM render FOLDER`. Its n-th call takes n seconds to solve, as far as its report says.
constexpr const char* kScript = R"(#!/bin/sh
echo x >> COUNT
n=$(wc -l < COUNT)
mkdir -p "$2/artefacts"
cat > "$2/artefacts/key_frames.json" <<END
KEYS
END
cat > "$2/report.json" <<END
REPORT
END
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
  return text;
}

class BenchRuns : public testing::Test {
 protected:
  void SetUp() override {
    api::JobReport report;
    report.outcome = "succeeded";
    report.stage_seconds = {{api::Stage::estimate, 0.5}, {api::Stage::solve, 77777}};
    report.peak_memory_bytes = 1000;
    api::KeyFrameReport keys;
    keys.frames = {
        {0, api::FrameKind::key, {}}, {1, api::FrameKind::interpolated, {}}, {2, api::FrameKind::check, {}}};
    std::string script = replaced(kScript, "KEYS", api::key_frame_report_json(keys));
    script = replaced(script, "REPORT", replaced(api::job_report_json(report), "77777", "$n"));
    std::ofstream(program()) << replaced(script, "COUNT", (folder_.path() / "count").string());
    std::filesystem::permissions(program(), std::filesystem::perms::owner_all);
  }
  std::filesystem::path program() const { return folder_.path() / "program"; }
  api::Result<BenchRun> run(const BenchJob& job, int repetitions) {
    return run_bench_job(job, kExamples, folder_.path() / "job", program(), repetitions);
  }
  std::size_t calls() const { return tests::bytes_of(folder_.path() / "count").size() / 2; }

  tests::TemporaryFolder folder_;
};

TEST_F(BenchRuns, AreRepeatedUntilThereAreEnoughAndTheMedianCounts) {
  const BenchJob job = bench_plan({})[2].full;
  const auto once = run(job, 1);
  ASSERT_TRUE(once) << once.error().message;
  EXPECT_EQ(once->computation_s, 1);
  EXPECT_EQ(once->estimation_s, 0.5);
  EXPECT_EQ(once->peak_memory_bytes, 1000u);
  EXPECT_EQ(solved_frames(once->key_frames), 2u);
  const auto thrice = run(job, 3);
  ASSERT_TRUE(thrice) << thrice.error().message;
  EXPECT_EQ(calls(), 3u);
  EXPECT_EQ(thrice->repetitions, 3);
  EXPECT_EQ(thrice->computation_s, 2);
  ASSERT_TRUE(run(job, 2));
  EXPECT_EQ(calls(), 3u) << "what was run is not run again";
}

// The n-th call says that it took n seconds: who ran when is seen in the times.
TEST_F(BenchRuns, BesideEachOtherTakeTurns) {
  BenchJob one = bench_plan({})[2].full, other = one;
  one.name = "one";
  other.name = "other";
  other.lighting.seed = 7;
  const BenchRunner runner{program(), kExamples, folder_.path() / "jobs"};
  const auto runs = run_in_turn({one, other}, runner, 3);
  ASSERT_TRUE(runs[0] && runs[1]);
  EXPECT_EQ(solve_seconds(*runs[0]), (std::vector<double>{1.5, 3.5, 5.5}));
  EXPECT_EQ(solve_seconds(*runs[1]), (std::vector<double>{2.5, 4.5, 6.5}));
}

TEST_F(BenchRuns, ThatAnyProgramMayLeaveAreKept) {
  BenchJob job = bench_plan({})[2].full;
  job.any_program = true;
  ASSERT_TRUE(run(job, 1));
  std::filesystem::last_write_time(program(), std::filesystem::file_time_type{} + std::chrono::hours(1));
  ASSERT_TRUE(run(job, 1));
  EXPECT_EQ(calls(), 1u);
}

TEST_F(BenchRuns, OfAnotherJobOrProgramCountForNothing) {
  BenchJob job = bench_plan({})[2].full;
  ASSERT_TRUE(run(job, 1));
  job.lighting.seed = 2;
  ASSERT_TRUE(run(job, 1));
  EXPECT_EQ(calls(), 2u);
  std::filesystem::last_write_time(program(), std::filesystem::file_time_type{} + std::chrono::hours(1));
  ASSERT_TRUE(run(job, 1));
  EXPECT_EQ(calls(), 3u);
}

}  // namespace
}  // namespace engine
