// How a worker's process lives and dies: real processes, real signals.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "api/exit_code.h"
#include "api/job_report.h"
#include "api/progress_line.h"
#include "engine/worker/supervision.h"
#include "tests/unit/worker/a_job_folder.h"

namespace {

using api::ExitCode;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// "exit 4", "signal 9", or "alive" after 10 s.
std::string end_of(pid_t process) {
  for (const auto give_up = Clock::now() + 10s; Clock::now() < give_up; std::this_thread::sleep_for(5ms)) {
    int status = 0;
    if (waitpid(process, &status, WNOHANG) != process) continue;
    if (WIFEXITED(status)) return "exit " + std::to_string(WEXITSTATUS(status));
    return "signal " + std::to_string(WTERMSIG(status));
  }
  return "alive";
}

std::string exit_with(ExitCode code) {
  return "exit " + std::to_string(static_cast<int>(code));
}

/// Only what is safe between fork and exec.
[[noreturn]] void become_worker(const std::vector<std::string>& words, int standard_input) {
  std::vector<char*> argv{const_cast<char*>(KEYLUME_WORKER_UNDER_TEST)};
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  dup2(standard_input, STDIN_FILENO);
  execv(argv[0], argv.data());
  _exit(98);
}

class WorkerLife : public testing::Test {
 protected:
  void SetUp() override {
    setenv("TSAN_OPTIONS", "atexit_sleep_ms=0", 0);  // that sanitizer sleeps for 1 s before every end
    ASSERT_EQ(pipe2(stdin_pipe_, O_CLOEXEC), 0);
    null_ = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    ASSERT_GE(null_, 0);
  }
  void TearDown() override {
    for (const pid_t process : started_) {
      kill(process, SIGKILL);
      waitpid(process, nullptr, 0);
    }
    for (const int file : {stdin_pipe_[0], stdin_pipe_[1], null_}) close(file);
  }

  std::string folder() const { return folder_.path.string(); }
  static std::string me() { return std::to_string(getpid()); }

  pid_t start(const std::vector<std::string>& words, std::optional<int> standard_input = {}) {
    const pid_t process = fork();
    if (process == 0) become_worker(words, standard_input.value_or(null_));
    started_.push_back(process);
    return process;
  }

  /// The worker has begun its work: its first progress line, or a check's file, is there.
  void wait_until_at_work() const {
    for (int i = 0; i < 2000; ++i) {
      if (!folder_.read("progress.ndjson").empty() || folder_.has("begun")) return;
      std::this_thread::sleep_for(5ms);
    }
    FAIL() << "the worker did not begin";
  }

  api::JobReport report(const char* file = "report.json") const {
    auto report = api::parse_job_report(folder_.read(file));
    EXPECT_TRUE(report) << report.error().message;
    return report ? *report : api::JobReport{};
  }

  tests::AJobFolder folder_;
  int stdin_pipe_[2] = {-1, -1};
  int null_ = -1;
  std::vector<pid_t> started_;
};

TEST_F(WorkerLife, SigtermStopsAPipelineThatListens) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const pid_t worker = start({"stop_when_told", "render", folder()});
    wait_until_at_work();
    const auto told = Clock::now();
    kill(worker, signal);
    EXPECT_EQ(end_of(worker), exit_with(ExitCode::stopped));
    EXPECT_LT(Clock::now() - told, 1s);
    EXPECT_EQ(report().outcome, "stopped");
    EXPECT_EQ(report().message, "told to stop");
    std::filesystem::remove(folder_.path / "progress.ndjson");
  }
}

TEST_F(WorkerLife, SigtermEndsAPipelineThatDoesNotListenWithinASecondAndLeavesAReport) {
  const pid_t worker = start({"never_listen", "render", folder()});
  wait_until_at_work();
  const auto told = Clock::now();
  kill(worker, SIGTERM);
  std::this_thread::sleep_for(300ms);
  kill(worker, SIGTERM);  // a second one does not move the deadline
  EXPECT_EQ(end_of(worker), exit_with(ExitCode::stopped));
  EXPECT_LT(Clock::now() - told, 1s);
  EXPECT_EQ(report().outcome, "stopped");
  EXPECT_FALSE(folder_.has(".tmp.last_words.report.json"));
}

/// Takes what is in a pipe, to its end.
std::string drained(int pipe) {
  std::string all;
  char piece[4096];
  for (ssize_t count; (count = read(pipe, piece, sizeof piece)) > 0;)
    all.append(piece, static_cast<std::size_t>(count));
  return all;
}

/// Does a thread of it stand in a write to standard error?
bool is_writing_errors(pid_t process) {
  const std::string writing = std::to_string(SYS_write) + " 0x2 ";
  std::error_code gone;
  for (const auto& thread :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", gone)) {
    std::string call;
    std::getline(std::ifstream(thread.path() / "syscall"), call);
    if (call.starts_with(writing)) return true;
  }
  return false;
}

// The work ends in time, and then saying so takes beyond the deadline: nobody reads standard error.
TEST_F(WorkerLife, TheThreadThatConcludesHasTheLastWordAlsoWhereItTakesLong) {
  for (const char* command : {"render", "check"}) {
    int errors[2];
    ASSERT_EQ(pipe2(errors, O_CLOEXEC), 0);
    const int usual = dup(STDERR_FILENO);
    dup2(errors[1], STDERR_FILENO);
    const pid_t worker = start({"fail_when_asked", command, folder()});
    dup2(usual, STDERR_FILENO);
    close(usual);
    wait_until_at_work();
    std::this_thread::sleep_for(200ms);  // what it says of its stage is said
    fcntl(errors[1], F_SETFL, O_NONBLOCK);
    while (write(errors[1], "x", 1) == 1) {
    }
    fcntl(errors[1], F_SETFL, 0);
    folder_.write("input/now", "");
    for (int i = 0; i < 2000 && !is_writing_errors(worker); ++i) std::this_thread::sleep_for(5ms);
    ASSERT_TRUE(is_writing_errors(worker)) << command;
    kill(worker, SIGTERM);
    std::this_thread::sleep_for(1300ms);  // the deadline is over
    close(errors[1]);
    const std::string said = drained(errors[0]);
    close(errors[0]);
    EXPECT_EQ(end_of(worker), exit_with(ExitCode::internal)) << command;
    const char* file = std::string(command) == "render" ? "report.json" : "check.json";
    EXPECT_EQ(report(file).outcome, "failed");
    EXPECT_EQ(report(file).message, "of its own accord");
    EXPECT_EQ(said.find("told to stop"), said.npos) << said.substr(said.find_last_of('x') + 1);
    for (const char* left : {"progress.ndjson", "begun", "input/now"})
      std::filesystem::remove(folder_.path / left);
  }
}

TEST_F(WorkerLife, TheLockGoesWithTheProcessHoweverItEnds) {
  for (const int signal : {SIGKILL, SIGTERM}) {
    const pid_t worker = start({"never_listen", "render", folder()});
    wait_until_at_work();
    kill(worker, signal);
    end_of(worker);
    std::filesystem::remove(folder_.path / "progress.ndjson");
    EXPECT_EQ(end_of(start({"describe_process", "render", folder()})), exit_with(ExitCode::ok));
    std::filesystem::remove(folder_.path / "progress.ndjson");
  }
}

TEST_F(WorkerLife, ASupervisedWorkerEndsWhenItsStandardInputCloses) {
  const pid_t worker = start({"never_listen", "render", folder(), "--parent", me()}, stdin_pipe_[0]);
  wait_until_at_work();
  ASSERT_EQ(write(stdin_pipe_[1], "ignored\n", 8), 8);
  std::this_thread::sleep_for(100ms);
  ASSERT_EQ(kill(worker, 0), 0);
  int status = 0;
  ASSERT_EQ(waitpid(worker, &status, WNOHANG), 0) << "input that goes on must not end it";
  close(stdin_pipe_[1]);
  stdin_pipe_[1] = -1;
  EXPECT_EQ(end_of(worker), exit_with(ExitCode::stopped));
}

TEST_F(WorkerLife, AWorkerStartedByHandDoesNotCareForItsStandardInput) {
  const pid_t worker = start({"stop_when_told", "render", folder()});  // /dev/null: at its end at once
  wait_until_at_work();
  std::this_thread::sleep_for(100ms);
  int status = 0;
  EXPECT_EQ(waitpid(worker, &status, WNOHANG), 0);
}

// The supervisor is killed while this test holds the other end of the worker's standard input: only the
// parent's death can tell the worker.
TEST_F(WorkerLife, ASupervisedWorkerIsKilledWhenItsParentDies) {
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // the orphan becomes ours, so that we learn its end
  int told[2];
  ASSERT_EQ(pipe2(told, O_CLOEXEC), 0);
  const pid_t supervisor = fork();
  if (supervisor == 0) {
    const std::vector<std::string> words{"never_listen", "render", folder(), "--parent", me()};
    const pid_t worker = fork();
    if (worker == 0) become_worker(words, stdin_pipe_[0]);
    [[maybe_unused]] const ssize_t written = write(told[1], &worker, sizeof worker);
    for (;;) pause();
  }
  started_.push_back(supervisor);
  pid_t worker = 0;
  ASSERT_EQ(read(told[0], &worker, sizeof worker), static_cast<ssize_t>(sizeof worker));
  started_.push_back(worker);
  close(told[0]);
  close(told[1]);
  wait_until_at_work();
  kill(supervisor, SIGKILL);
  EXPECT_EQ(end_of(worker), "signal " + std::to_string(SIGKILL));
}

TEST_F(WorkerLife, AWorkerWhoseParentIsAnotherAlreadyDoesNotBegin) {
  const pid_t worker = start({"never_listen", "render", folder(), "--parent", "1"}, stdin_pipe_[0]);
  EXPECT_EQ(end_of(worker), exit_with(ExitCode::internal));
  EXPECT_FALSE(folder_.has("progress.ndjson"));
}

TEST_F(WorkerLife, ASupervisedWorkerYieldsAndHoldsNothingOfItsSupervisor) {
  ASSERT_EQ(dup2(null_, 100), 100);  // not close-on-exec
  EXPECT_EQ(end_of(start({"describe_process", "render", folder(), "--parent", me()}, stdin_pipe_[0])),
            exit_with(ExitCode::ok));
  close(100);
  EXPECT_EQ(folder_.read("artefacts/process"),
            "no_new_privs 1\ncore 0\numask 23\nnice 10\noom_score_adj 500\ndeath_signal 9\n"
            "supervisors_file closed\n");
}

TEST_F(WorkerLife, AWorkerStartedByHandKeepsItsPriority) {
  EXPECT_EQ(end_of(start({"describe_process", "render", folder()})), exit_with(ExitCode::ok));
  const std::string ours = "nice " + std::to_string(getpriority(PRIO_PROCESS, 0)) + "\n";
  EXPECT_NE(folder_.read("artefacts/process").find("no_new_privs 1\ncore 0\numask 23\n" + ours),
            std::string::npos)
      << folder_.read("artefacts/process");
}

TEST_F(WorkerLife, AFullDiskHasAnExitCodeOfItsOwn) {
  constexpr int kMayNotMount = 77;
  const pid_t worker = fork();
  if (worker == 0) {  // with mounts of its own: the job's folder becomes a disk of 512 KiB
    if (unshare(CLONE_NEWNS) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) _exit(kMayNotMount);
    mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
    if (mount("tmpfs", folder().c_str(), "tmpfs", 0, "size=512k") != 0) _exit(kMayNotMount);
    folder_.write("input/animation.json", "{}");
    become_worker({"fill_the_disk", "render", folder()}, null_);
  }
  started_.push_back(worker);
  const std::string end = end_of(worker);
  if (end == "exit " + std::to_string(kMayNotMount)) GTEST_SKIP() << "no right to mount a small disk here";
  EXPECT_EQ(end, exit_with(ExitCode::disk_full));
}

TEST_F(WorkerLife, ACheckThatUsesUpItsProcessorTimeIsLimitExceededWithAReport) {
  EXPECT_EQ(end_of(start({"burn", "check", folder(), "--seconds", "1"})),
            exit_with(ExitCode::limit_exceeded));
  EXPECT_EQ(report("check.json").outcome, "failed");
  EXPECT_NE(report("check.json").message.find("1 s of processor time"), std::string::npos)
      << report("check.json").message;
}

TEST_F(WorkerLife, ACheckThatUsesUpItsMemoryIsLimitExceededWithAReport) {
  if (!engine::kMemoryCanBeLimited) GTEST_SKIP() << "built with a sanitizer";
  for (const std::uint64_t mib : {64, 256}) {
    EXPECT_EQ(end_of(start({"swallow_memory", "check", folder(), "--memory-mb", std::to_string(mib)})),
              exit_with(ExitCode::limit_exceeded));
    EXPECT_NE(report("check.json").message.find("memory"), std::string::npos) << report("check.json").message;
    EXPECT_GT(report("check.json").peak_memory_bytes, (mib / 2) << 20);
    EXPECT_LT(report("check.json").peak_memory_bytes, (mib + 64) << 20);
  }
}

TEST_F(WorkerLife, ACheckEndsAtOnceWhenToldToStop) {
  const pid_t worker = start({"never_listen", "check", folder()});
  wait_until_at_work();
  kill(worker, SIGTERM);
  EXPECT_EQ(end_of(worker), exit_with(ExitCode::stopped));
  EXPECT_EQ(report("check.json").outcome, "stopped");
}

TEST_F(WorkerLife, AWrongCommandLineEndsWithUsage) {
  EXPECT_EQ(end_of(start({"never_listen", "render", folder(), "--threads", "two"})),
            exit_with(ExitCode::usage));
  EXPECT_FALSE(folder_.has(".lock"));
}

}  // namespace
