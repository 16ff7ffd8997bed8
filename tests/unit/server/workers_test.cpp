// The supervisor with real processes: a worker that crashes, hangs, floods and lies.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

#include "server/jobs/collect_results.h"
#include "server/workers/check_command.h"
#include "server/workers/worker_log.h"
#include "tests/unit/server/workers_fixture.h"

namespace server {
namespace {

using api::JobState;
using namespace std::chrono_literals;

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

TEST(WorkerLogs, TellPathsFromTheFolderOfTheJob) {
  const TemporaryFolder folder;
  const std::filesystem::path job = folder.path() / "job_1";
  std::filesystem::create_directory(job);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
  const FileHandle output(ends[0]);
  FileHandle input(ends[1]);
  WorkerLog log(job, "attempt 1");
  ASSERT_TRUE(write_all(input, "cannot open '" + (job / "input/scene.obj").string() + "'\n" + job.string() +
                                   ": no room, nor in /tmp\n"));
  input = FileHandle();
  while (log.take_from(output)) {
  }
  const std::string told = "cannot open 'input/scene.obj'\n.: no room, nor in /tmp";
  EXPECT_EQ(log.tail(), told);
  const auto kept = read_below(job, "worker.log", 1000);
  ASSERT_TRUE(kept);
  EXPECT_EQ(*kept, "--- attempt 1\n" + told + "\n");
}

TEST(WorkerLogs, TellPathsThatComeInTwoPiecesTheSame) {
  const TemporaryFolder folder;
  const std::filesystem::path job = folder.path() / "job_1";
  std::filesystem::create_directory(job);
  const std::string whole = "cannot open '" + (job / "input/scene.obj").string() + "'\n" + job.string();
  for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
    std::filesystem::remove(job / "worker.log");
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
    const FileHandle output(ends[0]);
    FileHandle input(ends[1]);
    {
      WorkerLog log(job, "attempt 1");
      ASSERT_TRUE(write_all(input, std::string_view(whole).substr(0, cut)));
      EXPECT_TRUE(log.take_from(output));
      EXPECT_EQ(log.tail().find(folder.path().string()), std::string::npos) << log.tail();
      ASSERT_TRUE(write_all(input, std::string_view(whole).substr(cut)));
      EXPECT_TRUE(log.take_from(output));
      EXPECT_EQ(log.tail(), "cannot open 'input/scene.obj'\n.") << cut;
    }
    const auto kept = read_below(job, "worker.log", 1000);
    ASSERT_TRUE(kept);
    EXPECT_EQ(*kept, "--- attempt 1\ncannot open 'input/scene.obj'\n.") << cut;
  }
}

TEST(WorkerReports, TellPathsFromTheFolderOfTheJob) {
  const TemporaryFolder folder;
  const std::filesystem::path job = folder.path() / "job_1";
  api::JobReport report;
  report.outcome = "failed";
  report.message = "cannot write " + (job / "artefacts/radiosity.npy").string() + ": Input/output error";
  report.warnings = {"in " + job.string()};
  std::filesystem::create_directories(job / "views");
  for (const auto& [at, name] : {std::pair(job, "report.json"), std::pair(job / "views", "a.report.json")}) {
    std::ofstream(at / name) << api::job_report_json(report);
    const api::JobReport read = at == job ? read_report(job) : read_report_at(at, name);
    EXPECT_EQ(read.message, "cannot write artefacts/radiosity.npy: Input/output error");
    EXPECT_EQ(read.warnings, std::vector<std::string>{"in ."});
  }
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

TEST_F(WorkersTest, WhileTheWorkerProgramIsMissingJobsWaitAndTheQueueSaysWhy) {
  const std::filesystem::path program = temporary_.path() / "keylume";
  worker_rules_.program = program;
  worker_rules_.start_again_after = 20ms;
  worker_rules_.start_again_after_max = 40ms;
  const Job first = submit_that_will("succeed");
  const Job second = submit_that_will("succeed");
  start();
  ASSERT_TRUE(becomes_true([&] { return job(first.id).attempt > rules_.attempts_without_progress_max + 1; }));
  EXPECT_NE(jobs_->queue()->held.find(program), std::string::npos) << jobs_->queue()->held;
  ASSERT_TRUE(becomes_true([&] { return job(first.id).reason == "worker_not_started"; }));
  EXPECT_EQ(job(second.id).attempt, 0u) << "for the next one it would be the same";
  std::filesystem::create_symlink(KEYLUME_FAKE_WORKER, program);
  wait_for(first, JobState::succeeded);
  wait_for(second, JobState::succeeded);
  EXPECT_EQ(jobs_->queue()->held, "");
}

TEST_F(WorkersTest, AfterAFailedStartTheNextTryTakesItsTime) {
  worker_rules_.program = "/nonexistent/keylume";
  worker_rules_.start_again_after = 1h;
  const Job waits = submit_that_will("succeed");
  start();
  ASSERT_TRUE(becomes_true([&] { return job(waits.id).reason == "worker_not_started"; }));
  ASSERT_TRUE(jobs_->resume_queue());  // rings the bell
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(job(waits.id).attempt, 1u);
}

TEST_F(WorkersTest, WhatIsQuickToMakeAndSlowToReadIsNotRead) {
  for (const char* lie : {"publish_hard_links", "publish_holes", "publish_a_bloated_manifest"}) {
    const Job done = run_to_end(lie);
    EXPECT_EQ(done.state, JobState::failed) << lie;
    EXPECT_EQ(done.reason, "bad_artefacts") << lie;
    if (std::string_view(lie) == "publish_a_bloated_manifest") {
      EXPECT_NE(done.message.find("values"), std::string::npos) << done.message;
    }
  }
}

TEST_F(WorkersTest, WhatAWorkerPlantsAmongViewsAndVideosIsGoneBeforeAnybodySeesIt) {
  const Job done = run_to_end("plant_a_video");
  EXPECT_EQ(done.state, JobState::succeeded) << done.message;
  EXPECT_FALSE(std::filesystem::exists(jobs_->folder_of(done) / "videos"));
  EXPECT_FALSE(std::filesystem::exists(jobs_->folder_of(done) / "views"));
}

TEST_F(WorkersTest, AWorkerThatWritesFarMoreThanItMayIsStopped) {
  rules_.written.bytes = 3 << 20;
  rules_.written.bytes_per_frame = 0;
  restart();
  worker_rules_.measure_every = 10ms;
  const Job done = run_to_end("write_without_end");
  EXPECT_EQ(done.state, JobState::failed);
  EXPECT_EQ(done.reason, "limit_exceeded");
  EXPECT_NE(done.message.find("3145728 are allowed"), std::string::npos) << done.message;
}

TEST_F(WorkersTest, FoldersWithoutEndAreRefusedAndTheirJobCanBeDeleted) {
  worker_rules_.measure_every = 1h;
  const Job done = run_to_end("nest_folders");
  EXPECT_EQ(done.state, JobState::failed);
  EXPECT_EQ(done.reason, "limit_exceeded") << done.message;
  const api::Status removed = jobs_->remove(done.id);
  EXPECT_TRUE(removed) << removed.error().message;
  EXPECT_FALSE(std::filesystem::exists(folder_->job(done.id)));
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
