// The supervisor with real processes: a worker that crashes, hangs, floods and lies.
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "server/workers/check_command.h"
#include "server/workers/child_process.h"
#include "server/workers/supervisor.h"
#include "server/workers/worker_log.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::JobState;
using namespace std::chrono_literals;

constexpr auto kPatience = 20s;

bool is_alive(pid_t pid) {
  return bool(identity_of(pid));
}

template <class Condition>
bool becomes_true(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < deadline) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

class WorkersTest : public ServiceTest {
 protected:
  void SetUp() override {
    auto bell = Doorbell::create();
    ASSERT_TRUE(bell);
    bell_ = std::make_unique<Doorbell>(std::move(*bell));
    rules_.work_arrived = [this] { bell_->ring(); };
    rules_.cancel_requested = [this] { bell_->ring(); };
    worker_rules_.program = KEYLUME_FAKE_WORKER;
    worker_rules_.stop_grace = 300ms;
    worker_rules_.look_every = 10ms;
    worker_rules_.record_every = 20ms;
    ServiceTest::SetUp();
  }

  void TearDown() override { supervisor_.reset(); }

  void start() {
    supervisor_ = std::make_unique<Supervisor>(*jobs_, *bell_, worker_rules_);
    const api::Status started = supervisor_->start();
    ASSERT_TRUE(started) << started.error().message;
  }

  /// A job whose n-th attempt does what the n-th line says.
  Job submit_that_will(std::string_view behaviour) {
    const Upload upload = make_upload();
    write_text(folder_->upload(upload.id) / "behaviour", behaviour);
    auto submitted = jobs_->submit(upload);
    EXPECT_TRUE(submitted) << submitted.error().message;
    return *submitted;
  }

  Job wait_for(const Job& submitted, JobState state) {
    EXPECT_TRUE(becomes_true([&] { return job(submitted.id).state == state; }))
        << api::name_of(job(submitted.id).state) << ", not " << api::name_of(state) << ": "
        << job(submitted.id).message;
    return job(submitted.id);
  }

  Job run_to_end(std::string_view behaviour) {
    const Job submitted = submit_that_will(behaviour);
    start();
    EXPECT_TRUE(becomes_true([&] { return api::is_final(job(submitted.id).state); }))
        << api::name_of(job(submitted.id).state);
    return job(submitted.id);
  }

  pid_t worker_of(const Job& submitted) {
    pid_t pid = 0;
    EXPECT_TRUE(becomes_true([&] {
      pid = std::atoi(read_text(jobs_->folder_of(submitted) / "runs").c_str());
      return pid > 0 && job(submitted.id).fraction > 0;
    }));
    return pid;
  }

  std::unique_ptr<Doorbell> bell_;
  WorkerRules worker_rules_;
  std::unique_ptr<Supervisor> supervisor_;
};

TEST_F(WorkersTest, AnHonestWorkersResultsAreKept) {
  const Job done = run_to_end("succeed");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  EXPECT_EQ(done.fraction, 1);
  EXPECT_EQ(done.attempt, 1u);
  const auto files = jobs_->artefacts(done);
  ASSERT_TRUE(files);
  ASSERT_EQ(files->size(), 3u) << "two files and the manifest";
  EXPECT_EQ(jobs_->artefact(done, "radiosity.npy")->bytes, 7);
  EXPECT_NE(read_text(jobs_->folder_of(done) / "worker.log").find("all is well"), std::string::npos);
  EXPECT_NE(done.report.find("a warning"), std::string::npos);
}

TEST_F(WorkersTest, ACrashIsTriedAgain) {
  const Job done = run_to_end("crash\ncrash\nsucceed");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  EXPECT_EQ(done.attempt, 3u);
  const auto attempts = store_->attempts(done.seq);
  ASSERT_TRUE(attempts && attempts->size() == 3);
  EXPECT_EQ((*attempts)[0].end.signal, SIGSEGV);
  EXPECT_EQ((*attempts)[2].end.exit_code, 0);
}

TEST_F(WorkersTest, CrashingForEverEndsAfterThreeAttemptsWithSignalAndLog) {
  const Job done = run_to_end("crash");
  EXPECT_EQ(done.state, JobState::failed);
  EXPECT_EQ(done.reason, "worker_crashed");
  EXPECT_EQ(done.attempt, 3u);
  EXPECT_NE(done.message.find("SIGSEGV"), std::string::npos) << done.message;
  EXPECT_NE(done.message.find("about to crash"), std::string::npos) << done.message;
}

TEST_F(WorkersTest, AWorkerThatSaysNothingIsKilled) {
  worker_rules_.silence_max = 200ms;
  const Job done = run_to_end("hang");
  EXPECT_EQ(done.state, JobState::failed);
  EXPECT_EQ(done.reason, "stuck");
}

TEST_F(WorkersTest, SuccessWithoutFilesOrWithFalseOnesIsNotBelieved) {
  for (const char* lie : {"nothing", "lie_about_hash", "point_outside", "publish_a_link"}) {
    const Job done = run_to_end(lie);
    EXPECT_EQ(done.state, JobState::failed) << lie;
    EXPECT_EQ(done.reason, "bad_artefacts") << lie;
    EXPECT_TRUE(jobs_->artefacts(done)->empty()) << lie;
  }
}

TEST_F(WorkersTest, AnEndThatTheStoreCannotTakeHoldsUpNoOtherJob) {
  worker_rules_.retry_every = 50ms;
  const Job stuck = submit_that_will("crash\nsucceed");
  auto beside = Database::open(folder_->database());
  ASSERT_TRUE(beside &&
              beside->execute("CREATE TRIGGER refuse BEFORE UPDATE OF state ON job WHEN NEW.seq = 1 "
                              "AND NEW.state = 'queued' BEGIN SELECT RAISE(ABORT, 'no'); END"));
  const Job other = submit_that_will("succeed");
  start();
  wait_for(other, JobState::succeeded);
  EXPECT_EQ(job(stuck.id).state, JobState::running);
  ASSERT_TRUE(beside->execute("DROP TRIGGER refuse"));
  EXPECT_EQ(wait_for(stuck, JobState::succeeded).attempt, 2u);
}

TEST_F(WorkersTest, AnOrphanThatCannotBeTakenUpYetHoldsUpNothing) {
  worker_rules_.retry_every = 50ms;
  const Job orphan = submit_that_will("succeed");
  claim();  // and now kill -9
  restart();
  auto beside = Database::open(folder_->database());
  ASSERT_TRUE(beside &&
              beside->execute("CREATE TRIGGER refuse BEFORE UPDATE OF state ON job WHEN NEW.seq = 1 "
                              "AND NEW.state = 'queued' BEGIN SELECT RAISE(ABORT, 'no'); END"));
  const Job other = submit_that_will("succeed");
  start();
  wait_for(other, JobState::succeeded);
  EXPECT_EQ(job(orphan.id).state, JobState::running);
  ASSERT_TRUE(beside->execute("DROP TRIGGER refuse"));
  wait_for(orphan, JobState::succeeded);
}

TEST_F(WorkersTest, AFloodOfNonsenseEndsTheAttempt) {
  const Job done = run_to_end("flood_progress\nsucceed");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  EXPECT_EQ(store_->attempts(done.seq)->at(0).outcome, "worker_flooded");
}

TEST_F(WorkersTest, AFloodOnStandardErrorIsCutAndHarmless) {
  const Job done = run_to_end("flood_log_then_succeed");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  const auto size = std::filesystem::file_size(jobs_->folder_of(done) / "worker.log");
  EXPECT_LT(size, WorkerLog::kAttemptBytesMax + 1000);
}

TEST_F(WorkersTest, LinesThatAreNoProgressAreSkipped) {
  const Job done = run_to_end("garble_progress_then_succeed");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  EXPECT_EQ(done.attempt, 1u);
}

TEST_F(WorkersTest, NothingOfAWorkerOutlivesIt) {
  const Job done = run_to_end("leave_a_grandchild");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  const pid_t grandchild = std::atoi(read_text(jobs_->folder_of(done) / "grandchild").c_str());
  ASSERT_GT(grandchild, 0);
  EXPECT_TRUE(becomes_true([&] { return !is_alive(grandchild); }));
}

TEST_F(WorkersTest, AProcessThatHidFromItsGroupDoesNotOutliveTheWorkerEither) {
  const Job done = run_to_end("leave_a_hidden_process");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  const pid_t hidden = std::atoi(read_text(jobs_->folder_of(done) / "hidden").c_str());
  ASSERT_GT(hidden, 0);
  EXPECT_TRUE(becomes_true([&] { return !is_alive(hidden); }));
}

TEST_F(WorkersTest, RefusedAndTooLargeJobsAreNotTriedAgain) {
  const Job refused = run_to_end("refuse\nsucceed");
  EXPECT_EQ(refused.state, JobState::failed);
  EXPECT_EQ(refused.reason, "invalid_input");
  EXPECT_EQ(refused.message, "scene.obj is refused");
  const Job limited = submit_that_will("limit\nsucceed");
  EXPECT_EQ(wait_for(limited, JobState::failed).reason, "limit_exceeded");
}

TEST_F(WorkersTest, ARunningJobIsCanceledAtOnce) {
  const Job submitted = submit_that_will("wait_for_term");
  start();
  const pid_t worker = worker_of(submitted);
  const auto told = std::chrono::steady_clock::now();
  EXPECT_EQ(jobs_->cancel(submitted.id)->state, JobState::cancel_requested);
  wait_for(submitted, JobState::canceled);
  EXPECT_LT(std::chrono::steady_clock::now() - told, 2s);
  EXPECT_FALSE(is_alive(worker)) << "the state says canceled only once the worker is dead";
}

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

TEST_F(WorkersTest, AWorkerThatIgnoresTheWishToStopIsKilled) {
  const Job submitted = submit_that_will("ignore_term");
  start();
  const pid_t worker = worker_of(submitted);
  ASSERT_TRUE(jobs_->cancel(submitted.id));
  wait_for(submitted, JobState::canceled);
  EXPECT_FALSE(is_alive(worker));
}

TEST_F(WorkersTest, WhenTheServerStopsTheJobStaysQueuedAndIsNotBlamed) {
  const Job submitted = submit_that_will("wait_for_term\nsucceed");
  start();
  const pid_t worker = worker_of(submitted);
  supervisor_->stop();
  EXPECT_FALSE(is_alive(worker));
  EXPECT_EQ(job(submitted.id).state, JobState::queued);
  EXPECT_EQ(job(submitted.id).reason, "server_stopped");
  EXPECT_EQ(job(submitted.id).attempts_without_progress, 0u);
  start();
  EXPECT_EQ(wait_for(submitted, JobState::succeeded).attempt, 2u);
}

TEST_F(WorkersTest, AFullDiskLetsTheJobWait) {
  const Job submitted = submit_that_will("disk_full\nsucceed");
  start();
  ASSERT_TRUE(becomes_true([&] { return job(submitted.id).reason == "disk_full"; }));
  EXPECT_EQ(job(submitted.id).state, JobState::queued);
}

TEST_F(WorkersTest, AMissingWorkerProgramFailsTheJobAndSaysWhy) {
  worker_rules_.program = "/nonexistent/keylume";
  const Job done = run_to_end("succeed");
  EXPECT_EQ(done.state, JobState::failed);
  EXPECT_EQ(done.reason, "worker_not_started");
  EXPECT_NE(done.message.find("/nonexistent/keylume"), std::string::npos) << done.message;
}

TEST_F(WorkersTest, TheWorkerOfALostServerIsDeadBeforeItsJobRunsAgain) {
  const Job submitted = submit_that_will("ignore_term\nsucceed");
  // What a server leaves that ends between two instructions: a running job, and a worker without a parent's
  // care.
  const Claim claimed = claim();
  auto lost = ChildProcess::start(KEYLUME_FAKE_WORKER, {"render", jobs_->folder_of(submitted).string()});
  ASSERT_TRUE(lost);
  const auto identity = identity_of(lost->pid());
  ASSERT_TRUE(identity && jobs_->record_worker(claimed.lease, *identity));
  ASSERT_TRUE(
      becomes_true([&] { return std::filesystem::exists(jobs_->folder_of(submitted) / "progress.ndjson"); }));
  restart();
  start();
  EXPECT_FALSE(is_alive(static_cast<pid_t>(identity->pid)));
  EXPECT_EQ(wait_for(submitted, JobState::succeeded).attempt, 2u);
}

TEST(KillAndConfirm, SparesAnotherProcessThatGotThePid) {
  auto bystander = ChildProcess::start("/bin/sleep", {"1000"});
  ASSERT_TRUE(bystander);
  auto identity = identity_of(bystander->pid());
  ASSERT_TRUE(identity);
  ProcessIdentity earlier = *identity;
  earlier.start_ticks -= 1;
  EXPECT_TRUE(kill_and_confirm(earlier));
  EXPECT_TRUE(is_alive(bystander->pid()));
  ProcessIdentity before_reboot = *identity;
  before_reboot.boot_id = "another boot";
  EXPECT_TRUE(kill_and_confirm(before_reboot));
  EXPECT_TRUE(is_alive(bystander->pid()));
  EXPECT_TRUE(kill_and_confirm(*identity));
  EXPECT_FALSE(is_alive(bystander->pid()));
}

TEST(ChildProcess, InheritsNoDescriptorAndNoBlockedSignal) {
  sigset_t term;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  ASSERT_EQ(::pthread_sigmask(SIG_BLOCK, &term, nullptr), 0);
  const int leaky = ::dup(0);  // without close-on-exec
  auto child =
      ChildProcess::start("/bin/sh", {"-c", "ls /proc/self/fd | wc -l; grep SigBlk /proc/self/status"});
  ASSERT_TRUE(child);
  ASSERT_TRUE(becomes_true([&] { return child->has_ended(); }));
  std::string output(1000, '\0');
  output.resize(static_cast<std::size_t>(::read(child->output().get(), output.data(), output.size())));
  EXPECT_EQ(output, "4\nSigBlk:\t0000000000000000\n") << "0, 1, 2 and the one of ls itself";
  ::close(leaky);
  ::pthread_sigmask(SIG_UNBLOCK, &term, nullptr);
}

api::Status check_that_will(const std::filesystem::path& folder, std::string_view behaviour) {
  write_text(folder / "behaviour", behaviour);
  CheckRules rules;
  rules.program = KEYLUME_FAKE_WORKER;
  rules.time_max = 500ms;
  return make_check(rules)(folder);
}

TEST(Check, AnswersWhatTheWorkerFound) {
  const TemporaryFolder fine;
  EXPECT_TRUE(check_that_will(fine.path(), "nothing"));

  const TemporaryFolder wrong;
  const api::Status refused = check_that_will(wrong.path(), "refuse");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, api::Fault::invalid_request);
  ASSERT_EQ(refused.error().violations.size(), 1u);
  EXPECT_EQ(refused.error().violations[0].line, 12u);

  const TemporaryFolder large;
  EXPECT_EQ(check_that_will(large.path(), "limit").error().fault, api::Fault::invalid_request);
  const TemporaryFolder slow;
  EXPECT_EQ(check_that_will(slow.path(), "hang").error().fault, api::Fault::invalid_request);
  const TemporaryFolder broken;
  EXPECT_EQ(check_that_will(broken.path(), "crash").error().fault, api::Fault::internal);
}

}  // namespace
}  // namespace server
