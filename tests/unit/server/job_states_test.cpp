// Every event in every state: what the contract says happens, and nothing else.
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::Fault;
using api::JobEvent;
using api::JobState;

class JobStates : public ServiceTest {
 protected:
  /// A job brought into `state` by legal steps alone.
  Job job_in(JobState state) {
    Job made = submit();
    if (state == JobState::queued) return made;
    if (state == JobState::paused || state == JobState::canceled) {
      const auto reached = state == JobState::paused ? jobs_->pause(made.id) : jobs_->cancel(made.id);
      EXPECT_TRUE(reached);
      return job(made.id);
    }
    const Claim claimed = claim();
    EXPECT_EQ(claimed.job.id, made.id);
    lease_ = claimed.lease;
    if (state == JobState::pause_requested) (void)jobs_->pause(made.id);
    if (state == JobState::cancel_requested) (void)jobs_->cancel(made.id);
    if (state == JobState::succeeded) (void)store_->succeed(lease_, {}, "");
    if (state == JobState::failed) (void)store_->fail(lease_, {"r", "m"}, {}, "");
    return job(made.id);
  }

  api::Status happens(const Job& made, JobEvent event) {
    const auto done = [](const api::Result<Job>& result) {
      return result ? api::Status(api::Done{}) : api::Status(result.error());
    };
    switch (event) {
      case JobEvent::claimed: {
        const auto claimed = jobs_->claim();
        if (!claimed) return claimed.error();
        return *claimed ? api::Status(api::Done{}) : api::Error{Fault::wrong_state, "nothing to claim"};
      }
      case JobEvent::done:
        return store_->succeed(lease_, {}, "");
      case JobEvent::gave_up:
        return store_->fail(lease_, {"gave_up", ""}, {}, "");
      case JobEvent::interrupted:
        if (made.state == JobState::cancel_requested) return store_->finish_cancel(lease_, {});
        return store_->requeue(lease_, {"interrupted", ""}, {}, true);
      case JobEvent::cancel:
        return done(jobs_->cancel(made.id));
      case JobEvent::pause:
        return done(jobs_->pause(made.id));
      case JobEvent::resume:
        return done(jobs_->resume(made.id));
      case JobEvent::retry:
        return done(jobs_->retry(made.id));
      case JobEvent::deadline_passed:
        break;
    }
    api::JobOptions options;
    options.deadline_ms = {true, now_ms_ + 1};
    EXPECT_TRUE(jobs_->change(made.id, options, std::nullopt));
    now_ms_ += 2;
    const auto failed = store_->fail_overdue();
    if (!failed) return failed.error();
    return *failed == 1 ? api::Status(api::Done{}) : api::Error{Fault::wrong_state, "nothing was overdue"};
  }

  /// So that the next job is the only one that can be taken.
  void clear_queue() {
    const auto waiting = jobs_->list({.state = JobState::queued}, 10);
    ASSERT_TRUE(waiting);
    for (const Job& waits : waiting->jobs) ASSERT_TRUE(jobs_->cancel(waits.id));
  }

  Lease lease_;
};

TEST_F(JobStates, EveryEventInEveryStateLeadsWhereTheContractSays) {
  int allowed = 0;
  for (const JobState state : api::kJobStates)
    for (const JobEvent event : api::kJobEvents) {
      const std::string what = std::string(api::name_of(state)) + " x " + std::string(api::name_of(event));
      SCOPED_TRACE(what);
      lease_ = {};
      const Job before = job_in(state);
      ASSERT_EQ(before.state, state);
      const std::size_t events = store_->events(before.seq)->size();
      const api::Status status = happens(before, event);
      const Job after = job(before.id);
      auto expected = api::after(state, event);
      // Whoever ends an attempt must have seen the wish to cancel; then it ends by finish_cancel.
      const bool blind =
          state == JobState::cancel_requested && (event == JobEvent::done || event == JobEvent::gave_up);
      if (blind) expected.reset();
      EXPECT_EQ(bool(status), expected.has_value());
      EXPECT_EQ(api::name_of(after.state), api::name_of(expected.value_or(state)));
      const bool moved = expected && *expected != state;
      allowed += moved;
      EXPECT_EQ(store_->events(before.seq)->size(), events + moved) << "one event for every step";
      if (moved) {
        EXPECT_GT(after.version, before.version);
        const Event last = store_->events(before.seq)->back();
        EXPECT_EQ(last.from, state);
        EXPECT_EQ(last.to, *expected);
        EXPECT_EQ(last.reason, after.reason);
        EXPECT_EQ(after.finished_ms.has_value(), api::is_final(after.state));
      }
      EXPECT_TRUE(status || status.error().fault == Fault::wrong_state);
      clear_queue();
    }
  EXPECT_GT(allowed, 15);
}

TEST_F(JobStates, AWishToPauseKeepsTheCheckpointAndResumeGoesOnFromIt) {
  const Job made = submit();
  const Claim claimed = claim();
  write_text(jobs_->folder_of(made) / "checkpoint/solve", "half the light");
  ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.4, ""}));
  EXPECT_EQ(jobs_->pause(made.id)->state, JobState::pause_requested);
  EXPECT_EQ(jobs_->wanted(claimed.lease), Wanted::pause);
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::paused, "paused", "on request", {4, {}}, ""}));
  EXPECT_EQ(job(made.id).state, JobState::paused);
  EXPECT_EQ(job(made.id).fraction, 0.4) << "it shows how far it had come";
  EXPECT_FALSE(jobs_->claim()->has_value()) << "a paused job is not taken";
  EXPECT_EQ(jobs_->resume(made.id)->state, JobState::queued);
  EXPECT_EQ(claim().job.attempts_without_progress, 1u) << "a pause is no failed attempt";
  EXPECT_EQ(read_text(jobs_->folder_of(made) / "checkpoint/solve"), "half the light");
}

TEST_F(JobStates, AJobThatIsDoneWhileItIsToPauseHasSucceeded) {
  const Job made = submit();
  const Claim claimed = claim();
  ASSERT_TRUE(jobs_->pause(made.id));
  ASSERT_TRUE(store_->succeed(claimed.lease, {}, ""));
  EXPECT_EQ(job(made.id).state, JobState::succeeded);
}

TEST_F(JobStates, AWorkerThatDiesWhileItIsToPauseLeavesAPausedJob) {
  const Job made = submit();
  const Claim claimed = claim();
  ASSERT_TRUE(jobs_->pause(made.id));
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::lost, "worker_crashed", "", {{}, 11}, ""}));
  EXPECT_EQ(job(made.id).state, JobState::paused);
  EXPECT_EQ(job(made.id).attempts_without_progress, 1u);
}

TEST_F(JobStates, WishesUnderWayAreFinishedAtTheNextStart) {
  const Job to_pause = submit();
  claim();
  ASSERT_TRUE(jobs_->pause(to_pause.id));
  const Job to_cancel = submit();
  claim();
  ASSERT_TRUE(jobs_->cancel(to_cancel.id));
  const Job running = submit();
  claim();
  restart();
  const auto orphans = jobs_->orphans();
  ASSERT_TRUE(orphans && orphans->size() == 3);
  for (const Orphan& orphan : *orphans) ASSERT_TRUE(jobs_->take_up_again(orphan));
  EXPECT_EQ(job(to_pause.id).state, JobState::paused);
  EXPECT_EQ(job(to_cancel.id).state, JobState::canceled);
  EXPECT_EQ(job(running.id).state, JobState::queued);
}

TEST_F(JobStates, ARetryHasAllChancesAnewAndKeepsFilesAndCheckpoint) {
  const Job made = submit();
  for (std::uint32_t attempt = 0; attempt < rules_.attempts_without_progress_max; ++attempt) {
    const Claim claimed = claim();
    write_text(jobs_->folder_of(made) / "checkpoint/solve", "half the light");
    ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::lost, "worker_crashed", "", {{}, 11}, ""}));
  }
  ASSERT_EQ(job(made.id).state, JobState::failed);
  const auto again = jobs_->retry(made.id);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->state, JobState::queued);
  EXPECT_EQ(again->attempts_without_progress, 0u);
  EXPECT_FALSE(again->finished_ms.has_value());
  EXPECT_TRUE(std::filesystem::exists(jobs_->folder_of(made) / "checkpoint/solve"));
  EXPECT_EQ(claim().job.attempt, 4u) << "attempts go on counting";
}

TEST_F(JobStates, ARetryFromTheStartForgetsWhatWasMade) {
  const Job made = submit();
  write_text(jobs_->folder_of(made) / "checkpoint/solve", "poison");
  EXPECT_EQ(jobs_->retry(made.id, true).error().fault, Fault::wrong_state) << "it may be taken any moment";
  ASSERT_TRUE(jobs_->cancel(made.id));
  ASSERT_TRUE(jobs_->retry(made.id, true));
  EXPECT_FALSE(std::filesystem::exists(jobs_->folder_of(made) / "checkpoint"));
  EXPECT_TRUE(std::filesystem::exists(jobs_->folder_of(made) / "input/scene.obj"));
}

}  // namespace
}  // namespace server
