#include "server/artefacts/verify.h"
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

TEST(JobId, IsOfItsFormAndSortsByTime) {
  const std::string early = new_job_id(1'000'000);
  const std::string late = new_job_id(1'700'000'000'000);
  EXPECT_TRUE(is_job_id(early)) << early;
  EXPECT_LT(early, late);
  EXPECT_NE(new_job_id(5), new_job_id(5));
  EXPECT_FALSE(is_job_id("nobody"));
  EXPECT_FALSE(is_job_id("job_" + std::string(26, 'u')));
}

TEST_F(JobServiceTest, ASubmittedJobIsQueuedWithItsFilesInPlace) {
  const Job submitted = submit();
  EXPECT_EQ(submitted.state, JobState::queued);
  EXPECT_EQ(submitted.frame_count, 3u);
  EXPECT_EQ(submitted.attempt, 0u);
  EXPECT_TRUE(std::filesystem::exists(jobs_->folder_of(submitted) / "input/scene.obj"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
  EXPECT_EQ(store_->inputs(submitted.seq)->size(), 2u);
  restart();
  EXPECT_EQ(job(submitted.id).state, JobState::queued);
}

TEST_F(JobServiceTest, NothingIsLeftOfARefusedUpload) {
  const Upload bad_json = make_upload();
  write_text(folder_->upload(bad_json.id) / "input/animation.json",
             R"({"frames": {"count": 0}, "camras": {}})");
  const auto refused = jobs_->submit(bad_json);
  ASSERT_FALSE(refused);
  EXPECT_GE(refused.error().violations.size(), 2u);

  check_result_ =
      api::Error{Fault::invalid_request, "no", {{"scene.obj", "", 3, 7, "index_out_of_range", "no"}}};
  const auto also_refused = jobs_->submit(make_upload());
  ASSERT_FALSE(also_refused);
  EXPECT_EQ(also_refused.error().violations.at(0).line, 3u);

  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
  EXPECT_TRUE(std::filesystem::is_empty(folder_->jobs()));
  EXPECT_TRUE(jobs_->list({}, 10)->jobs.empty());
}

TEST_F(JobServiceTest, AFullQueueTakesNoMore) {
  rules_.queued_max = 2;
  restart();
  submit();
  submit();
  const auto refused = jobs_->submit(make_upload());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::out_of_resources);
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(JobServiceTest, AJobThatAlwaysCrashesFailsAfterThreeAttempts) {
  const std::string id = submit().id;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    const Claim claimed = claim();
    EXPECT_EQ(claimed.job.attempt, static_cast<std::uint32_t>(attempt));
    ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.5, ""}));
    ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
    EXPECT_EQ(job(id).state, attempt < 3 ? JobState::queued : JobState::failed);
  }
  const Job failed = job(id);
  EXPECT_EQ(failed.reason, "worker_crashed");
  EXPECT_NE(failed.message.find("SIGSEGV"), std::string::npos) << failed.message;
  EXPECT_NE(failed.message.find("bad luck"), std::string::npos) << failed.message;
}

TEST_F(JobServiceTest, AnAttemptThatGotFurtherThanAllBeforeGivesNewChances) {
  const std::string id = submit().id;
  const double reached[]{0.2, 0.2, 0.6, 0.6, 0.61, 0.6};
  for (const double fraction : reached) {
    ASSERT_EQ(job(id).state, JobState::queued) << fraction;
    const Claim claimed = claim();
    ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.5, fraction, ""}));
    ASSERT_TRUE(jobs_->end_attempt(claimed.lease, crash()));
  }
  EXPECT_EQ(job(id).state, JobState::failed) << "0.61 is no progress to speak of";
}

TEST_F(JobServiceTest, AServersEndIsNotHeldAgainstTheJob) {
  const std::string id = submit().id;
  for (int round = 0; round < 5; ++round) {
    claim();
    restart();
    const auto orphans = jobs_->orphans();
    ASSERT_TRUE(orphans);
    ASSERT_EQ(orphans->size(), 1u);
    ASSERT_TRUE(jobs_->take_up_again(orphans->front()));
    EXPECT_EQ(job(id).state, JobState::queued);
    EXPECT_EQ(job(id).reason, "server_restarted");
  }
  EXPECT_EQ(claim().job.attempt, 6u);
}

TEST_F(JobServiceTest, AJobThatIsThereWheneverTheServerDiesIsGivenUp) {
  const std::string id = submit().id;
  for (std::uint32_t round = 1; round <= rules_.orphaned_attempts_max; ++round) {
    ASSERT_EQ(job(id).state, JobState::queued) << round;
    // A clean stop in between is not counted.
    if (round == 3) {
      ASSERT_TRUE(
          jobs_->end_attempt(claim().lease, {OutcomeKind::server_stopped, "server_stopped", "", {}, ""}));
    }
    claim();
    restart();
    ASSERT_TRUE(jobs_->take_up_again(jobs_->orphans()->front()));
  }
  EXPECT_EQ(job(id).state, JobState::failed);
  EXPECT_EQ(job(id).reason, "server_restarted");
}

TEST_F(JobServiceTest, TheWorkerOfALostServerIsRememberedAcrossARestart) {
  submit();
  const Claim claimed = claim();
  ASSERT_TRUE(jobs_->record_worker(claimed.lease, {4711, 12345, "boot"}));
  restart();
  const auto orphans = jobs_->orphans();
  ASSERT_TRUE(orphans && orphans->size() == 1);
  ASSERT_TRUE(orphans->front().worker.has_value());
  EXPECT_EQ(orphans->front().worker->pid, 4711);
  EXPECT_EQ(orphans->front().worker->start_ticks, 12345);
  EXPECT_EQ(orphans->front().worker->boot_id, "boot");
}

TEST_F(JobServiceTest, AJobBeingCanceledWhenTheServerEndedIsCanceledAtTheNextStart) {
  const std::string id = submit().id;
  claim();
  EXPECT_EQ(jobs_->cancel(id)->state, JobState::cancel_requested);
  restart();
  const auto orphans = jobs_->orphans();
  ASSERT_TRUE(orphans && orphans->size() == 1);
  ASSERT_TRUE(jobs_->take_up_again(orphans->front()));
  EXPECT_EQ(job(id).state, JobState::canceled);
}

TEST_F(JobServiceTest, AWishToCancelWinsOverEveryOutcome) {
  for (const OutcomeKind kind : {OutcomeKind::done, OutcomeKind::refused, OutcomeKind::limit_exceeded,
                                 OutcomeKind::disk_full, OutcomeKind::server_stopped, OutcomeKind::lost}) {
    const std::string id = submit().id;
    const Claim claimed = claim();
    ASSERT_TRUE(jobs_->cancel(id));
    EXPECT_EQ(jobs_->wanted(claimed.lease), Wanted::cancel);
    ASSERT_TRUE(jobs_->end_attempt(claimed.lease, {kind, "r", "m", {}, ""}));
    EXPECT_EQ(job(id).state, JobState::canceled);
  }
}

TEST_F(JobServiceTest, CancelingTwiceIsTheSameAsOnce) {
  const std::string id = submit().id;
  EXPECT_EQ(jobs_->cancel(id)->state, JobState::canceled);
  EXPECT_EQ(jobs_->cancel(id)->state, JobState::canceled);
  EXPECT_EQ(jobs_->cancel("nobody").error().fault, Fault::not_found);
}

TEST_F(JobServiceTest, AFullDiskMakesTheJobWaitAndIsNotHeldAgainstIt) {
  const std::string id = submit().id;
  for (int round = 0; round < 5; ++round) {
    const Claim claimed = claim();
    ASSERT_TRUE(
        jobs_->end_attempt(claimed.lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, ""}));
    EXPECT_EQ(job(id).state, JobState::queued);
    EXPECT_FALSE(jobs_->claim()->has_value()) << "not at once";
    now_ms_ += rules_.disk_full_wait_ms << round;
  }
  ASSERT_TRUE(jobs_->end_attempt(claim().lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, ""}));
  now_ms_ -= 365LL * 24 * 3600 * 1000;  // the clock was set back while the server was down
  restart();
  ASSERT_TRUE(jobs_->clean_up());
  EXPECT_TRUE(jobs_->claim()->has_value());
}

TEST_F(JobServiceTest, AJobThatFillsTheDiskEveryTimeLeavesNothingHalfAndIsGivenUp) {
  const Job submitted = submit();
  for (std::uint32_t round = 1; round <= rules_.disk_full_attempts_max; ++round) {
    ASSERT_EQ(job(submitted.id).state, JobState::queued) << round;
    const Claim claimed = claim();
    write_text(jobs_->folder_of(submitted) / "artefacts/radiosity.npy", "half of it");
    ASSERT_TRUE(
        jobs_->end_attempt(claimed.lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, ""}));
    EXPECT_FALSE(std::filesystem::exists(jobs_->folder_of(submitted) / "artefacts"));
    now_ms_ += rules_.disk_full_wait_ms_max;
  }
  EXPECT_EQ(job(submitted.id).state, JobState::failed);
  EXPECT_EQ(job(submitted.id).reason, "disk_full");
}

TEST_F(JobServiceTest, ARetryForgetsWhatBefellEarlierAttempts) {
  const std::string id = submit().id;
  const auto fill_the_disk = [&] {
    ASSERT_TRUE(
        jobs_->end_attempt(claim().lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, ""}));
    now_ms_ += rules_.disk_full_wait_ms_max;
  };
  for (std::uint32_t round = 1; round <= rules_.disk_full_attempts_max; ++round) fill_the_disk();
  ASSERT_EQ(job(id).state, JobState::failed);
  for (std::uint32_t round = 1; round < rules_.disk_full_attempts_max; ++round) {
    if (round == 1) {
      ASSERT_TRUE(jobs_->retry(id));
    }
    fill_the_disk();
    ASSERT_EQ(job(id).state, JobState::queued) << round;
  }
  fill_the_disk();
  EXPECT_EQ(job(id).state, JobState::failed);
}

TEST_F(JobServiceTest, SoDoesProgress) {
  const std::string id = submit().id;
  for (std::uint32_t round = 1; round <= 2 * rules_.disk_full_attempts_max; ++round) {
    const Claim claimed = claim();
    if (round == rules_.disk_full_attempts_max) {
      ASSERT_TRUE(jobs_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.5, ""}));
    }
    ASSERT_TRUE(
        jobs_->end_attempt(claimed.lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, ""}));
    now_ms_ += rules_.disk_full_wait_ms_max;
    if (round < 2 * rules_.disk_full_attempts_max - 1) {
      ASSERT_EQ(job(id).state, JobState::queued) << round;
    }
    if (job(id).state == JobState::failed) break;
  }
  EXPECT_EQ(job(id).state, JobState::failed);
}

TEST_F(JobServiceTest, ARefusalByTheWorkerFailsAtOnceWithItsViolations) {
  const Job submitted = submit();
  const Claim claimed = claim();
  write_text(jobs_->folder_of(submitted) / "report.json",
             api::job_report_json(
                 {"failed", "scene.obj is wrong", {{"scene.obj", "", 1, 2, "syntax", "no"}}, {}, {}, {}, 0}));
  ASSERT_TRUE(
      jobs_->end_attempt(claimed.lease, {OutcomeKind::refused, "invalid_input", "refused", {2, {}}, ""}));
  const Job failed = job(submitted.id);
  EXPECT_EQ(failed.state, JobState::failed);
  EXPECT_EQ(failed.message, "scene.obj is wrong");
  const auto report = api::parse_job_report(failed.report);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->violations.at(0).code, "syntax");
}

/// What a worker leaves in the job's folder: these files, key-frames with these intervals, the manifest.
void publish(const std::filesystem::path& job_folder, const std::vector<std::string>& paths,
             const std::vector<api::KeyFrameInterval>& intervals) {
  std::string list;
  for (const std::string& path : paths) {
    write_text(job_folder / "artefacts" / path, "x");
    list.append(list.empty() ? "" : ",").append("{\"path\":\"").append(path);
    list.append("\",\"media_type\":\"image/png\",\"bytes\":1,\"sha256\":\"")
        .append(sha256_of("x"))
        .append("\"}");
  }
  api::KeyFrameReport report;
  for (api::FrameIndex frame = 0; frame < 3; ++frame)
    report.frames.push_back({frame, api::FrameKind::key, 0.0});
  report.intervals = intervals;
  write_text(job_folder / "artefacts/key_frames.json", api::key_frame_report_json(report));
  write_text(job_folder / "artefacts/manifest.json", "{\"artefacts\":[" + list + "]}");
}

AttemptOutcome done() {
  return {OutcomeKind::done, "", "", {0, std::nullopt}, ""};
}

TEST_F(JobServiceTest, ACameraMayHaveTwoDotsInItsName) {
  const Job submitted = submit();
  const Claim claimed = claim();
  publish(jobs_->folder_of(submitted), {"images/a..b/0000.png"}, {{0, 1, 0.1, {}}, {1, 2, 0.1, {}}});
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, done()));
  EXPECT_EQ(job(submitted.id).state, JobState::succeeded) << job(submitted.id).message;
}

TEST_F(JobServiceTest, IntervalsThatCannotBeAreALieOfTheWorker) {
  const std::vector<std::vector<api::KeyFrameInterval>> lies{
      {{0, 1, {}, {}}, {0, 1, {}, {}}},  // one twice
      {{1, 2, {}, {}}, {0, 1, {}, {}}},  // out of order
      {{0, 2, {}, {}}, {1, 2, {}, {}}},  // overlapping
      {{1, 1, {}, {}}},                  // empty
      {{0, 3, {}, {}}}};                 // beyond the animation
  for (const auto& intervals : lies) {
    const Job submitted = submit();
    const Claim claimed = claim();
    publish(jobs_->folder_of(submitted), {"radiosity.npy"}, intervals);
    ASSERT_TRUE(jobs_->end_attempt(claimed.lease, done()));
    EXPECT_EQ(job(submitted.id).reason, "bad_artefacts");
    ASSERT_TRUE(jobs_->cancel(submitted.id));
  }
}

TEST_F(JobServiceTest, ResultsThatTheStoreRefusesEndTheAttempt) {
  const Job submitted = submit();
  const Claim claimed = claim();
  publish(jobs_->folder_of(submitted), {"radiosity.npy"}, {});
  auto beside = Database::open(folder_->database());
  ASSERT_TRUE(beside && beside->execute("CREATE TRIGGER refuse BEFORE INSERT ON artefact BEGIN "
                                        "SELECT RAISE(ABORT, 'not this one'); END"));
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, done()));
  EXPECT_EQ(job(submitted.id).state, JobState::queued);
  EXPECT_EQ(job(submitted.id).reason, "bad_artefacts");
}

TEST_F(JobServiceTest, TheFramesOfAJobRemovedMeanwhileAreNotFound) {
  const Job submitted = submit();
  const Claim claimed = claim();
  publish(jobs_->folder_of(submitted), {"radiosity.npy"}, {});
  ASSERT_TRUE(jobs_->end_attempt(claimed.lease, done()));
  const Job read_earlier = job(submitted.id);
  EXPECT_EQ(jobs_->frames(read_earlier)->size(), 3u);
  ASSERT_TRUE(jobs_->remove(submitted.id));
  const auto frames = jobs_->frames(read_earlier);
  ASSERT_FALSE(frames);
  EXPECT_EQ(frames.error().fault, Fault::not_found);
}

TEST_F(JobServiceTest, ViolationsAreNotLostInALongReport) {
  const Job submitted = submit();
  const Claim claimed = claim();
  const std::vector<std::string> warnings(20'000, std::string(100, 'w'));
  write_text(
      jobs_->folder_of(submitted) / "report.json",
      api::job_report_json({"failed", "no", {{"a.obj", "", 1, 2, "syntax", "no"}}, warnings, {}, {}, 0}));
  ASSERT_TRUE(
      jobs_->end_attempt(claimed.lease, {OutcomeKind::refused, "invalid_input", "refused", {2, {}}, ""}));
  const auto report = api::parse_job_report(job(submitted.id).report);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->violations.size(), 1u);
}

TEST_F(JobServiceTest, ADatabaseThatCannotWriteDoesNotKeepTheServiceFromStarting) {
  const Job submitted = submit();
  ASSERT_TRUE(jobs_->cancel(submitted.id));
  ASSERT_TRUE(store_->begin_removal(submitted.id));
  submit();
  auto beside = Database::open(folder_->database());
  ASSERT_TRUE(beside &&
              beside->execute("CREATE TRIGGER a BEFORE DELETE ON job BEGIN SELECT RAISE(ABORT, 'no'); END; "
                              "CREATE TRIGGER b BEFORE UPDATE ON job BEGIN SELECT RAISE(ABORT, 'no'); END"));
  EXPECT_TRUE(jobs_->clean_up());
}

TEST_F(JobServiceTest, AJobThatHasNotRunHasNoReportOfItsCheck) {
  const Upload upload = make_upload();
  write_text(folder_->upload(upload.id) / "check.json",
             api::job_report_json({"succeeded", "", {}, {}, {}, {}, 0}));
  const auto submitted = jobs_->submit(upload);
  ASSERT_TRUE(submitted);
  EXPECT_FALSE(std::filesystem::exists(jobs_->folder_of(*submitted) / "check.json"));
  for (int attempt = 1; attempt <= 3; ++attempt) ASSERT_TRUE(jobs_->end_attempt(claim().lease, crash()));
  const Job failed = job(submitted->id);
  EXPECT_EQ(failed.state, JobState::failed);
  EXPECT_EQ(failed.report.find("succeeded"), std::string::npos) << failed.report;
}

}  // namespace
}  // namespace server
