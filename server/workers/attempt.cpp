#include "server/workers/attempt.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "api/exit_code.h"

namespace server {
namespace {

using std::chrono::duration_cast;
using std::chrono::milliseconds;
using std::chrono::seconds;

}  // namespace

// The tail is made before the worker starts, so that none of its lines is taken for one of an earlier
// attempt.
RunningAttempt::RunningAttempt(JobService& jobs, Claim claim, const WorkerRules& rules)
    : jobs_(jobs),
      claim_(std::move(claim)),
      rules_(rules),
      tail_(jobs.folder_of(claim_.job)),
      log_(jobs.folder_of(claim_.job), "attempt " + std::to_string(claim_.job.attempt)) {
  if (const auto forecast = api::parse_forecast(claim_.job.forecast))
    memory_bytes_ = static_cast<std::int64_t>(forecast->memory_bytes);
  start();
}

/// As much as all workers together may have, and never less than twice the forecast, which is an estimate:
/// a job that keeps to it is not disturbed, one that does not ends before the machine does.
std::uint64_t RunningAttempt::memory_limit() const {
  constexpr std::uint64_t kProgramBytes = 512u << 20;  // libraries and stacks, beside the job
  const auto budget = static_cast<std::uint64_t>(rules_.budget.memory_bytes);
  return std::max(budget, 2 * static_cast<std::uint64_t>(memory_bytes_)) + kProgramBytes;
}

void RunningAttempt::start() {
  // From a changed scene come wrong pictures, which nobody could tell from right ones.
  if (const api::Status whole = jobs_.must_have_whole_inputs(claim_.job); !whole) {
    not_started_ = whole.error().message;
    damaged_ = whole.error().fault == api::Fault::invalid_request;
    return;
  }
  std::vector<std::string> arguments{"render", jobs_.folder_of(claim_.job).string(), "--parent",
                                     std::to_string(::getpid()), "--sandbox"};
  arguments.insert(arguments.end(), rules_.render_options.begin(), rules_.render_options.end());
  ChildLimits limits;
  limits.memory_bytes = memory_limit();
  auto worker = ChildProcess::start(rules_.program, arguments, limits);
  if (!worker) {
    not_started_ = worker.error().message;
    return;
  }
  if (const auto identity = identity_of(worker->pid())) {
    // Without this record a later server could not make sure that this worker is dead: better no attempt.
    if (const api::Status recorded = jobs_.record_worker(claim_.lease, *identity); !recorded) {
      not_started_ = recorded.error().message;
      return;
    }
  }
  worker_.emplace(std::move(*worker));
}

void RunningAttempt::look(bool stopping, bool at_once) {
  if (!worker_) return;
  take_output();
  follow_progress(at_once);
  if (SteadyClock::now() >= next_measure_) measure();
  consider_ending(stopping);
}

// A folder of many files takes long to look through: a small share of the time, however many there are.
void RunningAttempt::measure() {
  constexpr int kShareOfTime = 20;
  const auto begin = SteadyClock::now();
  excess_ = jobs_.excess_of(claim_.job).value_or("");
  const auto end = SteadyClock::now();
  next_measure_ = end + std::max<SteadyClock::duration>(rules_.measure_every, kShareOfTime * (end - begin));
}

void RunningAttempt::take_output() {
  log_open_ = log_open_ && log_.take_from(worker_->output());
}

void RunningAttempt::follow_progress(bool at_once) {
  ProgressTail::News news = tail_.read();
  const auto now = SteadyClock::now();
  if (news.alive) last_line_ = last_sign_ = now;
  if (news.newest) unrecorded_ = std::move(news.newest);
  if (now < next_record_ && !at_once) return;
  next_record_ = now + rules_.record_every;
  if (unrecorded_) record();
  wanted_ = jobs_.wanted(claim_.lease, ran_ms());
  notice_signs_of_life();
}

void RunningAttempt::record() {
  const auto state = jobs_.record_progress(claim_.lease, *unrecorded_);
  if (!state && state.error().fault != api::Fault::wrong_state) return;  // kept for the next try
  unrecorded_.reset();
}

void RunningAttempt::notice_signs_of_life() {
  const std::int64_t ticks = processor_ticks_of(worker_->pid());
  if (ticks > processor_ticks_) last_sign_ = SteadyClock::now();
  processor_ticks_ = ticks;
}

RunningAttempt::Killed RunningAttempt::reason_to_end(bool stopping) const {
  const auto now = SteadyClock::now();
  switch (wanted_) {
    case Wanted::cancel:
      return Killed::canceled;
    case Wanted::pause:
      return Killed::paused;
    case Wanted::deadline_passed:
      return Killed::deadline_passed;
    case Wanted::run_time_exceeded:
      return Killed::run_time_exceeded;
    case Wanted::go_on:
      break;
  }
  if (stopping) return Killed::server_stopped;
  if (tail_.flooded()) return Killed::flooded;
  if (!excess_.empty()) return Killed::wrote_too_much;
  if (now - last_sign_ >= rules_.silence_max || now - last_line_ >= rules_.busy_silence_max)
    return Killed::stuck;
  return Killed::no;
}

void RunningAttempt::consider_ending(bool stopping) {
  const auto now = SteadyClock::now();
  const Killed reason = reason_to_end(stopping);
  if (killed_ == Killed::no && reason != Killed::no) {
    killed_ = reason;
    const bool polite =
        killed_ != Killed::stuck && killed_ != Killed::flooded && killed_ != Killed::wrote_too_much;
    worker_->signal_group(polite ? SIGTERM : SIGKILL);
    kill_at_ = now + (killed_ == Killed::canceled ? rules_.cancel_grace : rules_.stop_grace);
  } else if (killed_ == Killed::paused && reason == Killed::canceled) {
    killed_ = reason;  // nobody needs its checkpoint any more
    kill_at_ = std::min(kill_at_, now + rules_.cancel_grace);
  } else if (killed_ != Killed::no && now >= kill_at_) {
    worker_->signal_group(SIGKILL);
  }
}

std::int64_t RunningAttempt::ran_ms() const {
  return duration_cast<milliseconds>(SteadyClock::now() - began_).count();
}

AttemptOutcome RunningAttempt::end() {
  if (damaged_)
    return {
        OutcomeKind::damaged,
        "input_damaged",
        not_started_ + ": it was damaged on the disk of the service after it came in; submit the job again",
        {},
        {}};
  if (!worker_) return {OutcomeKind::not_started, "worker_not_started", not_started_, {}, {}};
  if (log_open_) (void)log_.take_from(worker_->output());
  ProgressTail::News news = tail_.read();
  if (news.newest) unrecorded_ = std::move(news.newest);
  if (unrecorded_) record();
  const ProcessEnd end = worker_->reap();
  worker_.reset();
  const bool finished_anyway = end.exit_code == static_cast<int>(api::ExitCode::ok);
  AttemptOutcome outcome = killed_ == Killed::no || finished_anyway
                               ? outcome_of(end)
                               : outcome_of_killing({end.exit_code, end.signal, std::nullopt});
  peak_bytes_ = end.peak_bytes;
  outcome.end.ran_ms = ran_ms();
  outcome.log_tail = log_.tail();
  return outcome;
}

std::int64_t RunningAttempt::peak_bytes() const {
  return worker_ ? peak_bytes_of(worker_->pid()) : peak_bytes_;
}

bool is_unexplained_kill(const AttemptOutcome& outcome) {
  return outcome.reason == "worker_crashed" && outcome.end.signal == SIGKILL;
}

void explain(KilledFor why, AttemptOutcome& outcome) {
  if (why == KilledFor::memory) {
    outcome.reason = "out_of_memory";
    outcome.message =
        "out of memory: all of this service together reached its limit, and the kernel killed the worker";
  } else if (why == KilledFor::perhaps) {
    outcome.message =
        "the worker was killed by SIGKILL together with others, of which the kernel killed some, not all, "
        "for want of memory; which of them is not known";
  }
}

// Whatever exit code or signal our own killing led to, it was our doing.
AttemptOutcome RunningAttempt::outcome_of_killing(const AttemptEnd& end) const {
  const auto outcome = [&](OutcomeKind kind, const char* reason, const std::string& message) {
    return AttemptOutcome{kind, reason, message, end, {}};
  };
  switch (killed_) {
    case Killed::stuck:
      return outcome(OutcomeKind::lost, "stuck",
                     "the worker made no progress for " +
                         std::to_string(duration_cast<seconds>(SteadyClock::now() - last_line_).count()) +
                         " s and was killed");
    case Killed::flooded:
      return outcome(OutcomeKind::lost, "worker_flooded",
                     "the worker wrote progress without end and was killed");
    case Killed::wrote_too_much:
      return outcome(OutcomeKind::limit_exceeded, "limit_exceeded",
                     "the worker was killed: it had written " + excess_);
    case Killed::server_stopped:
      return outcome(OutcomeKind::server_stopped, "server_stopped", "the server was stopped");
    case Killed::paused:
      return outcome(OutcomeKind::paused, "paused", "on request");
    case Killed::deadline_passed:
      return outcome(OutcomeKind::time_over, "deadline_passed", "it was not done by then");
    case Killed::run_time_exceeded:
      return outcome(OutcomeKind::time_over, "run_time_exceeded", "it ran for as long as it may");
    case Killed::canceled:
    case Killed::no:
      break;
  }
  return outcome(OutcomeKind::lost, "canceled", "the attempt was no longer wanted");
}

AttemptOutcome outcome_of(const ProcessEnd& end) {
  const AttemptEnd how{end.exit_code, end.signal};
  if (end.signal) {
    std::string message = "the worker was killed by " + signal_name(*end.signal);
    if (*end.signal == SIGKILL) message += " (by hand, or for want of memory)";
    return {OutcomeKind::lost, "worker_crashed", message, how, {}};
  }
  switch (static_cast<api::ExitCode>(end.exit_code.value_or(-1))) {
    case api::ExitCode::ok:
      return {OutcomeKind::done, "", "", how, {}};
    case api::ExitCode::invalid_input:
      return {OutcomeKind::refused, "invalid_input", "the worker refused the job", how, {}};
    case api::ExitCode::limit_exceeded:
      return {OutcomeKind::limit_exceeded,
              "limit_exceeded",
              "the job asks for more than the limits allow",
              how,
              {}};
    case api::ExitCode::disk_full:
      return {OutcomeKind::disk_full, "disk_full", "the disk is full; the job waits for room", how, {}};
    case api::ExitCode::stopped:
      return {OutcomeKind::lost, "worker_stopped", "somebody stopped the worker", how, {}};
    case api::ExitCode::internal:
    case api::ExitCode::usage:
      break;
  }
  return {OutcomeKind::lost,
          "worker_failed",
          "the worker ended with exit code " + std::to_string(end.exit_code.value_or(-1)),
          how,
          {}};
}

}  // namespace server
