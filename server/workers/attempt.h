// One attempt: a worker process from start to death.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/attempt_outcome.h"
#include "server/jobs/job_service.h"
#include "server/workers/child_process.h"
#include "server/workers/memory_kills.h"
#include "server/workers/progress_tail.h"
#include "server/workers/worker_log.h"

namespace server {

struct WorkerRules {
  std::filesystem::path program;                   ///< the worker executable
  std::vector<std::string> render_options;         ///< handed to `keylume render JOB_FOLDER` as they are
  WorkerBudget budget;                             ///< of all workers together
  std::int64_t cores_per_job = 1;                  ///< that a worker takes of the budget
  std::chrono::milliseconds silence_max{120'000};  ///< no progress line, no processor time: stuck, killed
  std::chrono::milliseconds busy_silence_max{1'800'000};  ///< no progress line, however busy: stuck, killed
  std::chrono::milliseconds stop_grace{5'000};            ///< from SIGTERM to SIGKILL, to save what is whole
  std::chrono::milliseconds cancel_grace{400};            ///< the same where nobody wants it any more
  std::chrono::milliseconds look_every{100};              ///< at the progress file
  std::chrono::milliseconds record_every{500};            ///< at most two writes to the store per second
  std::chrono::milliseconds retry_every{5'000};           ///< what the store could not take
  std::chrono::milliseconds collect_every{60'000};        ///< jobs whose time is over
  std::chrono::milliseconds measure_every{5'000};         ///< what a worker has written, at most so often
  std::chrono::milliseconds start_again_after{1'000};     ///< where no worker could be started; then doubled
  std::chrono::milliseconds start_again_after_max{60'000};
};

/// A worker on a claimed job. To be looked at often, by the thread that made it, which must live as long as
/// the worker.
class RunningAttempt {
 public:
  /// Starts the worker; where that fails, the attempt has ended at once.
  RunningAttempt(JobService& jobs, Claim claim, const WorkerRules& rules);
  RunningAttempt(const RunningAttempt&) = delete;
  RunningAttempt& operator=(const RunningAttempt&) = delete;

  const Claim& claim() const { return claim_; }
  /// As forecast; 0: not known.
  std::int64_t memory_bytes() const { return memory_bytes_; }
  /// Why there is no worker; empty: there is, or was, one.
  const std::string& why_not_started() const { return not_started_; }
  bool has_ended() const { return !worker_ || worker_->has_ended(); }
  /// To wait for (poll): the worker's end; more of its output, -1 when there is no more.
  int ended_descriptor() const { return worker_ ? worker_->ended_descriptor() : -1; }
  int output_descriptor() const { return worker_ && log_open_ ? worker_->output().get() : -1; }

  /// Takes its output and progress, and ends it where it is not wanted or stuck. `at_once`: somebody may have
  /// changed his mind about the job.
  void look(bool stopping, bool at_once);
  /// Reaps what has ended.
  AttemptOutcome end();
  /// The most that its worker was resident with; 0: not known.
  std::int64_t peak_bytes() const;

 private:
  using SteadyClock = std::chrono::steady_clock;

  /// Why we ended the worker ourselves.
  enum class Killed {
    no,
    canceled,
    paused,
    deadline_passed,
    run_time_exceeded,
    server_stopped,
    stuck,
    flooded,
    wrote_too_much
  };

  std::uint64_t memory_limit() const;
  void start();
  void take_output();
  void follow_progress(bool at_once);
  void record();
  void notice_signs_of_life();
  void measure();
  Killed reason_to_end(bool stopping) const;
  void consider_ending(bool stopping);
  std::int64_t ran_ms() const;
  AttemptOutcome outcome_of_killing(const AttemptEnd& end) const;

  JobService& jobs_;
  const Claim claim_;
  const WorkerRules& rules_;
  std::int64_t memory_bytes_ = 0;
  ProgressTail tail_;
  WorkerLog log_;
  std::optional<ChildProcess> worker_;
  std::string not_started_;  ///< why there is no worker
  bool damaged_ = false;     ///< that is why: an input is no longer what came in
  bool log_open_ = true;
  Wanted wanted_ = Wanted::go_on;
  Killed killed_ = Killed::no;
  std::optional<api::ProgressLine> unrecorded_;
  std::int64_t processor_ticks_ = 0;
  std::string excess_;           ///< what it wrote beyond what it may
  std::int64_t peak_bytes_ = 0;  ///< of a worker that is reaped
  const SteadyClock::time_point began_ = SteadyClock::now();
  SteadyClock::time_point last_line_ = began_;
  SteadyClock::time_point last_sign_ = began_;  ///< a line, or processor time taken
  SteadyClock::time_point next_record_{};
  SteadyClock::time_point next_measure_ = began_ + rules_.measure_every;
  SteadyClock::time_point kill_at_{};
};

/// The meaning of an exit code or signal that was not our doing.
AttemptOutcome outcome_of(const ProcessEnd& end);

/// Did SIGKILL end it, and none of us had sent it?
bool is_unexplained_kill(const AttemptOutcome& outcome);
/// Says in `outcome`, of such a kill, what is known of it.
void explain(KilledFor why, AttemptOutcome& outcome);

/// Largest resident set so far [bytes]; 0 where there is no such process.
std::int64_t peak_bytes_of(pid_t pid);

/// Of the process and its threads since it began, in clock ticks; 0 where there is no such process.
std::int64_t processor_ticks_of(pid_t pid);

}  // namespace server
