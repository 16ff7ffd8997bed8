// What a running job is told, several workers at once, and limits in time, with real processes.
#include <iostream>
#include <vector>

#include "tests/unit/server/workers_fixture.h"

namespace server {
namespace {

using api::JobState;
using namespace std::chrono_literals;

TEST_F(WorkersTest, ACanceledWorkerThatIgnoresItIsDeadWithinASecond) {
  worker_rules_.cancel_grace = WorkerRules{}.cancel_grace;
  const Job submitted = submit_that_will("ignore_term");
  start();
  const pid_t worker = worker_of(submitted);
  const auto told = std::chrono::steady_clock::now();
  ASSERT_TRUE(jobs_->cancel(submitted.id));
  ASSERT_TRUE(becomes_true([&] { return !is_alive(worker); }));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - told;
  std::cout << "from the wish to the dead worker " << took.count() << " s\n";
  EXPECT_LT(took, 5s) << "however busy this machine is; it should be under one";
  wait_for(submitted, JobState::canceled);
}

TEST_F(WorkersTest, APausedJobsWorkerIsStoppedAndGoesOnWhenResumed) {
  const Job submitted = submit_that_will("wait_for_term\nsucceed");
  start();
  const pid_t worker = worker_of(submitted);
  EXPECT_EQ(jobs_->pause(submitted.id)->state, JobState::pause_requested);
  const Job paused = wait_for(submitted, JobState::paused);
  EXPECT_FALSE(is_alive(worker));
  EXPECT_EQ(paused.reason, "paused");
  EXPECT_EQ(paused.attempts_without_progress, 0u);
  EXPECT_EQ(store_->attempts(submitted.seq)->at(0).end.exit_code, 4);
  ASSERT_TRUE(jobs_->resume(submitted.id));
  EXPECT_EQ(wait_for(submitted, JobState::succeeded).attempt, 2u);
}

TEST_F(WorkersTest, AWishToCancelOvertakesAWishToPause) {
  worker_rules_.stop_grace = 60s;
  const Job submitted = submit_that_will("ignore_term");
  start();
  worker_of(submitted);
  ASSERT_TRUE(jobs_->pause(submitted.id));
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(jobs_->cancel(submitted.id)->state, JobState::cancel_requested);
  wait_for(submitted, JobState::canceled);
}

TEST_F(WorkersTest, SeveralWorkersRunAtOnceWithinTheBudget) {
  worker_rules_.budget = {3, INT64_MAX};
  std::vector<Job> submitted;
  for (int i = 0; i < 4; ++i) submitted.push_back(submit_that_will("wait_for_term\nsucceed"));
  start();
  for (int i = 0; i < 3; ++i) worker_of(submitted[static_cast<std::size_t>(i)]);
  ASSERT_TRUE(becomes_true([&] { return jobs_->queue()->use.cores == 3; }));
  EXPECT_EQ(job(submitted[3].id).state, JobState::queued) << "there are three cores";
  ASSERT_TRUE(jobs_->pause(submitted[0].id));
  wait_for(submitted[0], JobState::paused);
  worker_of(submitted[3]);
  EXPECT_EQ(job(submitted[1].id).state, JobState::running) << "the others go on";
  supervisor_->stop();
  for (int i = 1; i < 4; ++i)
    EXPECT_EQ(job(submitted[static_cast<std::size_t>(i)].id).state, JobState::queued);
}

TEST_F(WorkersTest, AJobThatNeedsMoreMemoryThanThereIsRunsAlone) {
  constexpr std::int64_t kMegabyte = 1 << 20;
  worker_rules_.budget = {8, 100 * kMegabyte};
  const auto submit_with_memory = [&](std::int64_t bytes) {
    const Upload upload = make_upload();
    write_text(folder_->upload(upload.id) / "behaviour", "wait_for_term");
    write_text(folder_->upload(upload.id) / "check.json",
               R"({"outcome": "succeeded", "message": "", "violations": [], "warnings": [],
                   "stage_seconds": [], "counts": [], "peak_memory_bytes": 1, "forecast": {"polygons": 2,
                   "patches": 30, "frames": 3, "seconds": 0.5, "memory_bytes": )" +
                   std::to_string(bytes) + "}}");
    auto made = jobs_->submit(upload);
    EXPECT_TRUE(made);
    return *made;
  };
  const Job huge = submit_with_memory(500 * kMegabyte);
  const Job small = submit_with_memory(40 * kMegabyte);
  const Job other_small = submit_with_memory(40 * kMegabyte);
  const Job third_small = submit_with_memory(40 * kMegabyte);
  start();
  worker_of(huge);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(job(small.id).state, JobState::queued);
  ASSERT_TRUE(jobs_->cancel(huge.id));
  worker_of(small);
  worker_of(other_small);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(job(third_small.id).state, JobState::queued) << "80 of 100 MB are taken";
}

TEST_F(WorkersTest, AWorkerThatComputesInSilenceIsGivenTimeButNotForEver) {
  worker_rules_.silence_max = 300ms;
  worker_rules_.busy_silence_max = 2s;
  const Job submitted = submit_that_will("compute_in_silence");
  const auto begun = std::chrono::steady_clock::now();
  start();
  ASSERT_TRUE(becomes_true([&] {
    return !store_->attempts(submitted.seq)->empty() && store_->attempts(submitted.seq)->at(0).ended_ms;
  }));
  EXPECT_GT(std::chrono::steady_clock::now() - begun, 1s) << "longer than silence alone would allow";
  EXPECT_EQ(store_->attempts(submitted.seq)->at(0).outcome, "stuck");
}

TEST_F(WorkersTest, AWaitingJobFailsAtItsDeadlineAlsoWhileAllCoresAreTaken) {
  const Job blocking = submit_that_will("wait_for_term");
  start();
  worker_of(blocking);
  const auto late = jobs_->submit(make_upload());
  api::JobOptions options;
  options.deadline_ms = {true, now_ms_ + 1};
  ASSERT_TRUE(late && jobs_->change(late->id, options, std::nullopt));
  now_ms_ += 2;
  EXPECT_EQ(wait_for(*late, JobState::failed).reason, "deadline_passed");
  EXPECT_EQ(job(blocking.id).state, JobState::running);
}

TEST_F(WorkersTest, AJobThatRunsTooLongIsStoppedForGood) {
  Upload upload = make_upload();
  upload.options = R"({"max_run_seconds": 1})";
  write_text(folder_->upload(upload.id) / "behaviour", "wait_for_term");
  const auto submitted = jobs_->submit(upload);
  ASSERT_TRUE(submitted);
  start();
  const Job failed = wait_for(*submitted, JobState::failed);
  EXPECT_EQ(failed.reason, "run_time_exceeded");
  EXPECT_GE(failed.run_ms, 1000);
  EXPECT_EQ(failed.attempt, 1u);
}

}  // namespace
}  // namespace server
