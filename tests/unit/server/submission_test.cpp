// What comes with a job, what a client may have, and jobs that are submitted twice.
#include <thread>

#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;
using namespace std::chrono_literals;

class Submission : public ServiceTest {
 protected:
  Upload upload_with(std::string options, std::string owner = "") {
    Upload upload = make_upload();
    upload.options = std::move(options);
    upload.owner = std::move(owner);
    return upload;
  }
  api::Result<Submitted> submit_with_key(const Upload& upload, const std::string& key) {
    const auto held = jobs_->hold_key(upload.owner, key);
    EXPECT_TRUE(held);
    return jobs_->submit(upload, *held);
  }
  void finish(const Job& made) {
    const Claim claimed = claim();
    ASSERT_EQ(claimed.job.id, made.id);
    ASSERT_TRUE(store_->fail(claimed.lease, {"test", ""}, {}, ""));
  }
  bool nothing_is_left() {
    return std::filesystem::is_empty(folder_->uploads()) && std::filesystem::is_empty(folder_->jobs());
  }
};

TEST_F(Submission, OptionsComeWithTheJobAndSurviveARestart) {
  const auto made = jobs_->submit(
      upload_with(R"({"name": "evening", "priority": 80, "labels": {"project": "garage", "shot": ""},
                      "deadline": "2023-11-14T22:13:30+00:00", "max_run_seconds": 60, "ttl_seconds": 5,
                      "pinned": true})",
                  "anna"));
  ASSERT_TRUE(made) << made.error().message;
  restart();
  const Job kept = job(made->id);
  EXPECT_EQ(kept.owner, "anna");
  EXPECT_EQ(kept.settings.name, "evening");
  EXPECT_EQ(kept.settings.priority, 80u);
  EXPECT_EQ(kept.settings.labels, (api::Labels{{"project", "garage"}, {"shot", ""}}));
  EXPECT_EQ(kept.settings.deadline_ms, 1'700'000'010'000);
  EXPECT_EQ(kept.settings.max_run_ms, 60'000);
  EXPECT_EQ(kept.settings.ttl_ms, 5'000);
  EXPECT_TRUE(kept.settings.pinned);
}

TEST_F(Submission, WrongOptionsAreRefusedWithTheirPlaces) {
  const auto refused = jobs_->submit(upload_with(R"({"priority": 101, "lables": {}, "pinned": 1})"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::invalid_request);
  EXPECT_EQ(refused.error().violations.size(), 3u);
  EXPECT_EQ(refused.error().violations.front().file, "options");
  const auto late = jobs_->submit(upload_with(R"({"deadline": "2023-11-14T22:13:20Z"})"));
  ASSERT_FALSE(late) << "now is no time to be done by";
  EXPECT_EQ(late.error().violations.at(0).pointer, "/deadline");
  EXPECT_TRUE(nothing_is_left());
}

TEST_F(Submission, AJobThatIsNotStartedByItsDeadlineHasFailed) {
  const auto made = jobs_->submit(upload_with(R"({"deadline": "2023-11-14T22:14:00Z"})"));
  ASSERT_TRUE(made);
  const auto paused = jobs_->submit(upload_with(R"({"deadline": "2023-11-14T22:14:00Z"})"));
  ASSERT_TRUE(paused && jobs_->pause(paused->id));
  now_ms_ += 40'000;
  EXPECT_FALSE(jobs_->claim()->has_value());
  for (const std::string& id : {made->id, paused->id}) {
    EXPECT_EQ(job(id).state, JobState::failed);
    EXPECT_EQ(job(id).reason, "deadline_passed");
  }
  const auto again = jobs_->retry(made->id);
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->settings.deadline_ms.has_value()) << "it would end it at once";
  EXPECT_EQ(claim().job.id, made->id);
}

TEST_F(Submission, ARunningJobIsStoppedAtItsDeadlineAndAtItsRunTime) {
  const auto late = jobs_->submit(upload_with(R"({"deadline": "2023-11-14T22:14:00Z"})"));
  ASSERT_TRUE(late);
  const Claim of_late = claim();
  EXPECT_EQ(jobs_->wanted(of_late.lease), Wanted::go_on);
  now_ms_ += 40'000;
  EXPECT_EQ(jobs_->wanted(of_late.lease), Wanted::deadline_passed);
  ASSERT_TRUE(jobs_->end_attempt(of_late.lease, {OutcomeKind::time_over, "deadline_passed", "", {}, ""}));
  EXPECT_EQ(job(late->id).state, JobState::failed);

  const auto slow = jobs_->submit(upload_with(R"({"max_run_seconds": 10})"));
  ASSERT_TRUE(slow);
  const Claim first = claim();
  EXPECT_EQ(jobs_->wanted(first.lease, 9'999), Wanted::go_on);
  EXPECT_EQ(jobs_->wanted(first.lease, 10'000), Wanted::run_time_exceeded);
  ASSERT_TRUE(jobs_->pause(slow->id));
  ASSERT_TRUE(jobs_->end_attempt(first.lease, {OutcomeKind::paused, "paused", "", {4, {}, 7'000}, ""}));
  ASSERT_TRUE(jobs_->resume(slow->id));
  const Claim second = claim();
  EXPECT_EQ(jobs_->wanted(second.lease, 2'999), Wanted::go_on);
  EXPECT_EQ(jobs_->wanted(second.lease, 3'000), Wanted::run_time_exceeded) << "all attempts together";
}

TEST_F(Submission, ChangesAreCheckedAgainstTheVersion) {
  const Job made = submit();
  const auto options = api::parse_job_options(R"({"priority": 99, "labels": {"a": "b"}, "ttl_seconds": 3})");
  ASSERT_TRUE(options);
  const auto changed = jobs_->change(made.id, *options, made.version);
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_EQ(changed->settings.priority, 99u);
  EXPECT_EQ(changed->version, made.version + 1);
  EXPECT_EQ(jobs_->change(made.id, *options, made.version).error().fault, Fault::changed);
  const auto taken_away = api::parse_job_options(R"({"ttl_seconds": null})");
  ASSERT_TRUE(taken_away);
  const auto without = jobs_->change(made.id, *taken_away, std::nullopt);
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->settings.ttl_ms.has_value());
  EXPECT_EQ(without->settings.labels.at("a"), "b") << "what is not given stays";
}

TEST_F(Submission, ListsAreFilteredByOwnerAndLabels) {
  ASSERT_TRUE(jobs_->submit(upload_with(R"({"labels": {"project": "a", "shot": "1"}})", "anna")));
  ASSERT_TRUE(jobs_->submit(upload_with(R"({"labels": {"project": "a"}})", "bert")));
  ASSERT_TRUE(jobs_->submit(upload_with(R"({"labels": {"project": "b"}})", "bert")));
  const auto count = [&](const JobFilter& filter) { return jobs_->list(filter, 10)->jobs.size(); };
  EXPECT_EQ(count({.owner = "bert"}), 2u);
  EXPECT_EQ(count({.labels = {{"project", "a"}}}), 2u);
  EXPECT_EQ(count({.labels = {{"project", std::nullopt}}}), 3u);
  EXPECT_EQ(count({.labels = {{"project", "a"}, {"shot", "1"}}}), 1u);
  EXPECT_EQ(count({.owner = "bert", .labels = {{"project", "a"}}}), 1u);
  EXPECT_EQ(count({.state = JobState::running, .owner = "bert"}), 0u);
}

TEST_F(Submission, TheSameKeyAndUploadAnswerTheSameJob) {
  const auto first = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_FALSE(first->replayed);
  const auto second = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_TRUE(second->replayed);
  EXPECT_EQ(second->job.id, first->job.id);
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 1u);
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(Submission, AKeySurvivesACrashBetweenCommitAndAnswer) {
  const auto first = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(first);
  restart();  // the client never saw the answer
  ASSERT_TRUE(jobs_->clean_up());
  const auto second = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->replayed);
  EXPECT_EQ(second->job.id, first->job.id);
}

TEST_F(Submission, AKeyBelongsToOneUploadOfOneOwner) {
  const auto first = submit_with_key(upload_with("", "anna"), "key");
  ASSERT_TRUE(first);
  const auto others = submit_with_key(upload_with("", "bert"), "key");
  ASSERT_TRUE(others);
  EXPECT_NE(others->job.id, first->job.id);
  Upload changed = upload_with("", "anna");
  write_text(folder_->upload(changed.id) / "input/scene.obj", "v 1 1 1\n");
  const auto refused = submit_with_key(changed, "key");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::invalid_request);
  EXPECT_EQ(refused.error().violations.at(0).code, "reused_key");
  EXPECT_FALSE(submit_with_key(upload_with(R"({"priority": 1})", "anna"), "key")) << "options count too";
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(Submission, ARefusedUploadLeavesItsKeyFree) {
  EXPECT_FALSE(submit_with_key(upload_with("{"), "key"));
  const auto mended = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(mended);
  EXPECT_FALSE(mended->replayed);
}

TEST_F(Submission, KeysAreForgottenAfterADayAndWithTheirJob) {
  const auto first = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(first);
  now_ms_ += rules_.key_ms - 1;
  EXPECT_TRUE(submit_with_key(make_upload(), "key")->replayed);
  now_ms_ += 1;
  const auto next_day = submit_with_key(make_upload(), "key");
  ASSERT_TRUE(next_day);
  EXPECT_FALSE(next_day->replayed);
  ASSERT_TRUE(jobs_->cancel(next_day->job.id) && jobs_->remove(next_day->job.id));
  EXPECT_FALSE(submit_with_key(make_upload(), "key")->replayed);
}

TEST_F(Submission, AKeyIsHeldByOneRequestAtATime) {
  auto held = jobs_->hold_key("anna", "key");
  ASSERT_TRUE(held);
  EXPECT_FALSE(jobs_->hold_key("anna", "key"));
  EXPECT_TRUE(jobs_->hold_key("bert", "key")) << "another owner's is another one";
  const HeldKey moved = std::move(*held);
  held.reset();
  EXPECT_FALSE(jobs_->hold_key("anna", "key")) << "moved, not let go";
}

TEST_F(Submission, QuotasOfJobsAndBytesAreKept) {
  rules_.queued_of_one_owner_max = 2;
  rules_.bytes_of_one_owner_max = 300;
  rules_.bytes_max = 500;
  restart();
  ASSERT_TRUE(jobs_->submit(upload_with("", "anna")));  // 108 bytes by its inputs
  ASSERT_TRUE(jobs_->submit(upload_with("", "anna")));
  EXPECT_EQ(jobs_->submit(upload_with("", "anna")).error().fault, Fault::too_many);
  claim();
  EXPECT_EQ(jobs_->submit(upload_with("", "anna")).error().fault, Fault::over_quota);
  ASSERT_TRUE(jobs_->submit(upload_with("", "bert")));
  ASSERT_TRUE(jobs_->submit(upload_with("", "bert")));
  const auto full = jobs_->submit(upload_with("", "carl"));
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().fault, Fault::over_quota);
  EXPECT_NE(full.error().message.find("432 of 500"), std::string::npos) << full.error().message;
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(Submission, WhatAJobMadeCountsToo) {
  const Job made = submit();
  const Claim claimed = claim();
  write_text(jobs_->folder_of(made) / "checkpoint/solve", std::string(1000, 'x'));
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {OutcomeKind::refused, "invalid_input", "", {2, {}}, ""}));
  EXPECT_GT(job(made.id).bytes, 1000);
  EXPECT_EQ(*store_->total_bytes(), job(made.id).bytes);
}

TEST_F(Submission, JobsWhoseTimeIsOverAreRemovedUnlessPinned) {
  const auto brief = jobs_->submit(upload_with(R"({"ttl_seconds": 10})"));
  const auto pinned = jobs_->submit(upload_with(R"({"ttl_seconds": 10, "pinned": true})"));
  const auto kept = jobs_->submit(upload_with("{}"));
  ASSERT_TRUE(brief && pinned && kept);
  for (const Job& made : {*brief, *pinned, *kept}) finish(made);
  const auto waiting = jobs_->submit(upload_with(R"({"ttl_seconds": 10})"));
  ASSERT_TRUE(waiting);
  now_ms_ += 9'999;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_TRUE(jobs_->job(brief->id));
  now_ms_ += 1;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_EQ(jobs_->job(brief->id).error().fault, Fault::not_found);
  EXPECT_FALSE(std::filesystem::exists(folder_->job(brief->id)));
  for (const std::string& id : {pinned->id, kept->id, waiting->id}) EXPECT_TRUE(jobs_->job(id));
  EXPECT_EQ(jobs_->garbage().jobs, 1);
  EXPECT_GT(jobs_->garbage().bytes, 0);
  EXPECT_EQ(jobs_->garbage().last_ms, now_ms_);
}

TEST_F(Submission, ARemovalCanBeLookedAtBefore) {
  const Job made = submit();
  EXPECT_EQ(jobs_->what_remove_deletes(made.id).error().fault, Fault::wrong_state);
  finish(made);
  const auto removal = jobs_->what_remove_deletes(made.id);
  ASSERT_TRUE(removal);
  EXPECT_EQ(removal->files, 2);
  EXPECT_GT(removal->bytes, 8);
  EXPECT_TRUE(jobs_->job(made.id)) << "and nothing is gone";
}

TEST_F(Submission, WaitingEndsWithTheJobOrWithThePatience) {
  const Job made = submit();
  EXPECT_EQ(jobs_->wait_until_final(made.id, 1ms)->state, JobState::queued);
  EXPECT_EQ(jobs_->wait_until_final("nobody", 1ms).error().fault, Fault::not_found);
  const auto begun = std::chrono::steady_clock::now();
  std::thread other([&] {
    std::this_thread::sleep_for(50ms);
    (void)jobs_->cancel(made.id);
  });
  EXPECT_EQ(jobs_->wait_until_final(made.id, 60s)->state, JobState::canceled);
  other.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 30s);
}

TEST_F(Submission, FewMayWaitAtOnceAndNoneOnceTheServerStops) {
  rules_.waiters_max = 1;
  restart();
  const Job made = submit();
  // Until it has the one place, which the loop below takes for moments.
  std::thread waiter([&] {
    while (!jobs_->wait_until_final(made.id, 60s)) std::this_thread::yield();
  });
  const auto begun = std::chrono::steady_clock::now();
  while (jobs_->wait_until_final(made.id, 0ms) && std::chrono::steady_clock::now() - begun < 20s)
    std::this_thread::sleep_for(1ms);
  EXPECT_EQ(jobs_->wait_until_final(made.id, 60s).error().fault, Fault::out_of_resources);
  jobs_->stop_waiting();
  waiter.join();
  EXPECT_EQ(jobs_->wait_until_final(made.id, 60s)->state, JobState::queued);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 30s);
}

}  // namespace
}  // namespace server
