// Uploads that are only looked at, and what a job tells and keeps between its attempts.
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

using JobServiceTest = ServiceTest;

AttemptOutcome crash() {
  return {OutcomeKind::lost,
          "worker_crashed",
          "the worker was killed by SIGSEGV",
          {std::nullopt, 11},
          "bad luck"};
}

TEST_F(JobServiceTest, AValidatedUploadIsAnsweredAndNothingIsKept) {
  const Upload good = make_upload();
  // As the worker's check leaves it.
  write_text(folder_->upload(good.id) / "check.json",
             R"({"outcome": "succeeded", "message": "", "violations": [], "warnings": ["it is dark"],
                 "stage_seconds": [], "counts": [], "peak_memory_bytes": 1, "forecast": {"polygons": 2,
                 "patches": 30, "frames": 3, "memory_bytes": 4000, "seconds": 0.5}})");
  const auto report = jobs_->validate(good);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->warnings, std::vector<std::string>{"it is dark"});
  ASSERT_TRUE(report->forecast);
  EXPECT_EQ(report->forecast->patches, 30u);
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
  EXPECT_TRUE(std::filesystem::is_empty(folder_->jobs()));
  EXPECT_TRUE(jobs_->list({}, 10)->jobs.empty());

  check_result_ = api::Error{Fault::invalid_request, "no", {{"scene.obj", "", 3, 7, "syntax", "no"}}};
  const auto refused = jobs_->validate(make_upload());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().violations.at(0).line, 3u);
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(JobServiceTest, TheTimeLeftIsThatOfTheWorkerAtWork) {
  const Job submitted = submit();
  EXPECT_FALSE(submitted.seconds_left);
  const Claim claimed = claim();
  ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.5, "", 42.5}));
  EXPECT_EQ(job(submitted.id).seconds_left, 42.5);
  ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.6, 0.6, ""}));
  EXPECT_FALSE(job(submitted.id).seconds_left) << "it cannot tell any more";
  ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.7, 0.7, "", 12}));
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
  EXPECT_FALSE(job(submitted.id).seconds_left) << "nobody is at it";
}

// A client that has seen the end need not look again, and what it read then is what it may change.
TEST_F(JobServiceTest, NothingOfAJobChangesAfterItsEnd) {
  const Job submitted = submit();
  {
    auto watcher = Database::open(folder_->database());
    ASSERT_TRUE(watcher);
    ASSERT_TRUE(
        watcher->execute("CREATE TRIGGER too_late BEFORE UPDATE ON job WHEN OLD.finished_ms IS NOT NULL "
                         "BEGIN SELECT RAISE(ABORT, 'the job had ended'); END"));
  }
  const Claim claimed = claim();
  write_text(jobs_->folder_of(submitted) / "worker.log", std::string(12'345, 'x'));
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::refused, "invalid_input", "no", {2, {}}, {}}));
  EXPECT_EQ(job(submitted.id).state, JobState::failed);
  EXPECT_GE(job(submitted.id).bytes, 12'345) << "its size was known by then";
}

// What the next attempt goes on from is kept for as long as there may be one: a failed or canceled job can be
// tried again.
class CheckpointsOfAJob : public ServiceTest {
 protected:
  std::filesystem::path checkpoint(const Job& job) { return jobs_->folder_of(job) / "checkpoint"; }
  Claim claim_with_checkpoint() {
    Claim claimed = claim();
    write_text(checkpoint(claimed.job) / "solve", "half the light");
    return claimed;
  }
};

TEST_F(CheckpointsOfAJob, OutliveACrashAndAServerThatIsStopped) {
  submit();
  Claim claimed = claim_with_checkpoint();
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
  EXPECT_EQ(job(claimed.job.id).state, JobState::queued);
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job) / "solve"));
  claimed = claim();
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::server_stopped, "server_stopped", "", {}, {}}));
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job) / "solve"));
  claimed = claim();
  restart();
  const auto orphans = jobs_->orphans();
  ASSERT_TRUE(orphans && orphans->size() == 1);
  ASSERT_TRUE(jobs_->take_up_again(orphans->front()));
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job) / "solve"));
}

TEST_F(CheckpointsOfAJob, OutliveAFailure) {
  submit();
  Claim claimed = claim_with_checkpoint();
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::refused, "invalid_input", "no", {2, {}}, {}}));
  EXPECT_EQ(job(claimed.job.id).state, JobState::failed);
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job)));

  submit();
  for (std::uint32_t attempt = 0; attempt < rules_.attempts_without_progress_max; ++attempt) {
    claimed = claim_with_checkpoint();
    ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
  }
  EXPECT_EQ(job(claimed.job.id).state, JobState::failed);
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job)));
}

TEST_F(CheckpointsOfAJob, OutliveACancelRunningOrWaiting) {
  submit();
  Claim claimed = claim_with_checkpoint();
  ASSERT_TRUE(jobs_->cancel(claimed.job.id));
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
  EXPECT_EQ(job(claimed.job.id).state, JobState::canceled);
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job)));

  submit();
  claimed = claim_with_checkpoint();
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
  ASSERT_TRUE(jobs_->cancel(claimed.job.id));
  EXPECT_EQ(job(claimed.job.id).state, JobState::canceled);
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job)));
}

TEST_F(CheckpointsOfAJob, StayOfAJobThatWaitsForRoomWhereThereIsRoomWithoutItsArtefacts) {
  submit();
  const Claim claimed = claim_with_checkpoint();
  write_text(jobs_->folder_of(claimed.job) / "artefacts/radiosity.npy", "half of it");
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, {}}));
  EXPECT_EQ(job(claimed.job.id).state, JobState::queued);
  EXPECT_FALSE(std::filesystem::exists(jobs_->folder_of(claimed.job) / "artefacts"));
  EXPECT_TRUE(std::filesystem::exists(checkpoint(claimed.job))) << "this test needs 64 MiB of free disk";
}

}  // namespace
}  // namespace server
