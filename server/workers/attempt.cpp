#include "server/workers/attempt.h"

#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <utility>

#include "api/exit_code.h"
#include "server/workers/progress_tail.h"
#include "server/workers/worker_log.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

/// Why we ended the worker ourselves.
enum class Killed { no, canceled, server_stopped, stuck, flooded };

/// The watch over one living worker.
class Watch {
 public:
  Watch(JobService& jobs, const Claim& claim, const WorkerRules& rules, ChildProcess& worker,
        ProgressTail tail)
      : jobs_(jobs),
        claim_(claim),
        rules_(rules),
        worker_(worker),
        tail_(std::move(tail)),
        log_(jobs.folder_of(claim.job), "attempt " + std::to_string(claim.job.attempt)) {}

  void run(const Doorbell& bell, const std::atomic<bool>& stopping) {
    while (!worker_.has_ended()) {
      wait(bell);
      log_open_ = log_open_ && log_.take_from(worker_.output());
      follow_progress();
      consider_ending(stopping);
    }
    if (log_open_) (void)log_.take_from(worker_.output());
    follow_progress();
    if (unrecorded_) record();
  }

  Killed killed() const { return killed_; }
  std::string log_tail() const { return log_.tail(); }

 private:
  void wait(const Doorbell& bell) {
    // A closed pipe is always readable: once it is at its end, poll must not look at it.
    std::array<pollfd, 3> events{pollfd{worker_.ended_descriptor(), POLLIN, 0},
                                 pollfd{bell.descriptor(), POLLIN, 0},
                                 pollfd{log_open_ ? worker_.output().get() : -1, POLLIN, 0}};
    (void)::poll(events.data(), events.size(), static_cast<int>(rules_.look_every.count()));
    if (events[1].revents & POLLIN) {
      bell.clear();
      next_record_ = {};  // look at once whether the job is still wanted
    }
  }

  void follow_progress() {
    ProgressTail::News news = tail_.read();
    const auto now = SteadyClock::now();
    if (news.alive) last_sign_ = now;
    if (news.newest) unrecorded_ = std::move(news.newest);
    if (now < next_record_) return;
    next_record_ = now + rules_.record_every;
    if (unrecorded_)
      record();
    else if (!jobs_.still_wanted(claim_.lease))
      wanted_ = false;
  }

  void record() {
    const auto state = jobs_.record_progress(claim_.lease, *unrecorded_);
    if (!state && state.error().fault != api::Fault::wrong_state) return;  // kept for the next try
    unrecorded_.reset();
    if (!state || *state != api::JobState::running) wanted_ = false;
  }

  void consider_ending(const std::atomic<bool>& stopping) {
    const auto now = SteadyClock::now();
    if (killed_ == Killed::no) {
      if (wanted_ && !stopping && now - last_sign_ < rules_.silence_max && !tail_.flooded()) return;
      killed_ = !wanted_          ? Killed::canceled
                : stopping        ? Killed::server_stopped
                : tail_.flooded() ? Killed::flooded
                                  : Killed::stuck;
      const bool polite = killed_ == Killed::canceled || killed_ == Killed::server_stopped;
      worker_.signal_group(polite ? SIGTERM : SIGKILL);
      kill_at_ = now + rules_.stop_grace;
    } else if (now >= kill_at_) {
      worker_.signal_group(SIGKILL);
    }
  }

  JobService& jobs_;
  const Claim& claim_;
  const WorkerRules& rules_;
  ChildProcess& worker_;
  ProgressTail tail_;
  WorkerLog log_;
  bool log_open_ = true;
  bool wanted_ = true;
  Killed killed_ = Killed::no;
  std::optional<api::ProgressLine> unrecorded_;
  SteadyClock::time_point last_sign_ = SteadyClock::now();
  SteadyClock::time_point next_record_{};
  SteadyClock::time_point kill_at_{};
};

AttemptOutcome not_started(const api::Error& error) {
  return {OutcomeKind::lost, "worker_not_started", error.message, {}, {}};
}

// Whatever exit code or signal our own killing led to, it was our doing.
AttemptOutcome outcome_of_killing(Killed killed, const ProcessEnd& end, const WorkerRules& rules) {
  const AttemptEnd how{end.exit_code, end.signal};
  switch (killed) {
    case Killed::stuck:
      return {OutcomeKind::lost,
              "worker_stuck",
              "the worker gave no sign for " + std::to_string(rules.silence_max.count() / 1000) +
                  " s and was killed",
              how,
              {}};
    case Killed::flooded:
      return {OutcomeKind::lost,
              "worker_flooded",
              "the worker wrote progress without end and was killed",
              how,
              {}};
    case Killed::server_stopped:
      return {OutcomeKind::server_stopped, "server_stopped", "the server was stopped", how, {}};
    case Killed::canceled:
    case Killed::no:
      break;
  }
  return {OutcomeKind::lost, "canceled", "the attempt was no longer wanted", how, {}};
}

}  // namespace

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

AttemptOutcome run_attempt(JobService& jobs, const Claim& claim, const WorkerRules& rules,
                           const Doorbell& bell, const std::atomic<bool>& stopping) {
  std::vector<std::string> arguments{"render", jobs.folder_of(claim.job).string(), "--parent",
                                     std::to_string(::getpid()), "--sandbox"};
  arguments.insert(arguments.end(), rules.render_options.begin(), rules.render_options.end());
  // Before the worker starts, so that none of its lines is taken for one of an earlier attempt.
  ProgressTail tail(jobs.folder_of(claim.job));
  auto worker = ChildProcess::start(rules.program, arguments);
  if (!worker) return not_started(worker.error());
  if (const auto identity = identity_of(worker->pid())) {
    // Without this record a later server could not make sure that this worker is dead: better no attempt.
    const api::Status recorded = jobs.record_worker(claim.lease, *identity);
    if (!recorded) return not_started(recorded.error());
  }
  Watch watch(jobs, claim, rules, *worker, std::move(tail));
  watch.run(bell, stopping);
  const ProcessEnd end = worker->reap();
  const bool finished_anyway = end.exit_code == static_cast<int>(api::ExitCode::ok);
  AttemptOutcome outcome = watch.killed() == Killed::no || finished_anyway
                               ? outcome_of(end)
                               : outcome_of_killing(watch.killed(), end, rules);
  outcome.log_tail = watch.log_tail();
  return outcome;
}

}  // namespace server
