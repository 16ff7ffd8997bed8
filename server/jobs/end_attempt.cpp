// The part of JobService that decides what becomes of a job whose worker is dead.
#include <algorithm>
#include <utility>

#include "api/fault_point.h"
#include "server/artefacts/files.h"
#include "server/jobs/collect_results.h"
#include "server/jobs/folder_size.h"
#include "server/jobs/job_service.h"
#include "server/log.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

constexpr const char* kServerRestarted = "server_restarted";

/// What the worker wrote, or nothing but the outcome: which of them it is the server knows, whatever the
/// worker says.
std::string report_text(api::JobReport report, const char* outcome) {
  report.outcome = outcome;
  return api::job_report_json(report);
}

std::string with_log(const AttemptOutcome& outcome) {
  if (outcome.log_tail.empty()) return outcome.message;
  return outcome.message + "; its last words: " + outcome.log_tail;
}

}  // namespace

// A worker that is started on a full disk only writes until it fails, and each try makes the wait for the
// next one longer, until the job is given up. So none is.
api::Result<bool> JobService::is_held() {
  const api::Status room = has_room(folder_.jobs());
  const bool full = !room && room.error().fault == Fault::disk_full;
  const std::lock_guard lock(state_);
  if (full == held_) return full;
  if (!full)
    if (const api::Status forgotten = store_.forget_waiting_times(); !forgotten) return forgotten.error();
  log_line(full ? "no job is started: " + room.error().message : "there is room on the disk; jobs go on");
  return held_ = full;
}

api::Result<std::optional<Claim>> JobService::claim(const Room& room) {
  if (const api::Status failed = fail_overdue(); !failed) return failed.error();
  const auto held = is_held();
  if (!held) return held.error();
  if (*held) return std::optional<Claim>();
  auto claim = store_.claim(room);
  if (claim && *claim) tell_change();
  return claim;
}

api::Status JobService::fail_overdue() {
  if (clock_doubt_.is_doubtful()) return api::Done{};
  const auto overdue = store_.fail_overdue();
  if (!overdue) return overdue.error();
  if (*overdue > 0) tell_change();
  return api::Done{};
}

Wanted JobService::wanted(const Lease& lease, std::int64_t ran_ms) {
  const auto job = store_.leased_job(lease);
  // A store that cannot be read for a moment is no reason to end a worker.
  if (!job) return job.error().fault == Fault::wrong_state ? Wanted::cancel : Wanted::go_on;
  if (job->state == JobState::cancel_requested) return Wanted::cancel;
  if (job->state == JobState::pause_requested) return Wanted::pause;
  if (job->settings.deadline_ms && *job->settings.deadline_ms <= clock_() && !clock_doubt_.is_doubtful())
    return Wanted::deadline_passed;
  if (job->settings.max_run_ms && job->run_ms + ran_ms >= *job->settings.max_run_ms)
    return Wanted::run_time_exceeded;
  return Wanted::go_on;
}

api::Status JobService::end_attempt(const Lease& lease, const AttemptOutcome& outcome,
                                    const std::atomic<bool>& stopping) {
  api::fault_point("worker_ended");
  const auto job = store_.leased_job(lease);
  if (!job) return job.error();
  api::Status settled = settle(*job, lease, outcome, stopping);
  if (!settled && settled.error().fault == Fault::wrong_state) {
    // Somebody asked to cancel between our look and our step.
    const auto again = store_.leased_job(lease);
    if (!again) return again.error();
    settled = settle(*again, lease, outcome, stopping);
  }
  tell_change();
  return settled;
}

// Before the step that ends the attempt: who sees a job that has finished sees all of it, and its version
// stays. For quotas, which may be a little behind: no reason for an attempt not to end.
void JobService::record_bytes(const Job& job) {
  const api::Status recorded = store_.record_bytes(job.seq, size_of_folder(folder_of(job)).bytes);
  if (!recorded) log_line(job.id + ": its size cannot be recorded: " + recorded.error().message);
}

// Of a job that has succeeded. Before the step that ends it: a crash in between costs work done twice, and
// not a file that stays for good.
void JobService::forget_checkpoint(const Job& job) const {
  const api::Status removed = remove_tree(folder_.job(job.id) / "checkpoint");
  if (!removed) log_line(job.id + ": " + removed.error().message);
}

std::optional<std::string> JobService::excess_of(const Job& job) const {
  const WrittenRules& rules = rules_.written;
  const FolderSize size = size_of_folder(folder_of(job), {rules.files, rules.depth});
  if (size.beyond)
    return "more than " + std::to_string(rules.files) + " files, or folders " + std::to_string(rules.depth) +
           " deep";
  double most = static_cast<double>(rules.bytes) +
                static_cast<double>(job.frame_count) * static_cast<double>(rules.bytes_per_frame);
  if (const auto forecast = api::parse_forecast(job.forecast))
    most += static_cast<double>(rules.bytes_per_value) * static_cast<double>(forecast->patches) *
            static_cast<double>(job.frame_count);
  most = std::min(
      {most, static_cast<double>(rules_.bytes_max), static_cast<double>(rules_.bytes_of_one_owner_max)});
  // Neither holes nor the rest of each file's last block: quotas count neither.
  const std::int64_t written = std::min(size.bytes, size.on_disk_bytes);
  if (static_cast<double>(written) <= most) return std::nullopt;
  return std::to_string(written) + " bytes, " + std::to_string(static_cast<std::int64_t>(most)) +
         " are allowed";
}

api::Status JobService::settle(const Job& job, const Lease& lease, const AttemptOutcome& outcome,
                               const std::atomic<bool>& stopping) {
  // The checkpoint stays, also of a job that is canceled or has failed: it may be tried again.
  const bool folder_changes = outcome.kind == OutcomeKind::done || outcome.kind == OutcomeKind::disk_full;
  if (job.state == JobState::cancel_requested || !folder_changes) record_bytes(job);
  if (job.state == JobState::cancel_requested) return store_.finish_cancel(lease, outcome.end);
  const StepReason why{outcome.reason, with_log(outcome)};
  switch (outcome.kind) {
    case OutcomeKind::done:
      return succeed(job, lease, outcome, stopping);
    case OutcomeKind::refused:
    case OutcomeKind::limit_exceeded: {
      const api::JobReport report = read_report(folder_.job(job.id));
      const std::string message = report.message.empty() ? why.message : report.message;
      return store_.fail(lease, {outcome.reason, message}, outcome.end, report_text(report, "failed"));
    }
    case OutcomeKind::disk_full:
      return wait_for_room_or_fail(job, lease, outcome);
    // What the worker said last explains nothing where it was us who stopped it.
    case OutcomeKind::time_over:
    case OutcomeKind::damaged:
      return store_.fail(lease, {outcome.reason, outcome.message}, outcome.end,
                         report_text(read_report(folder_.job(job.id)), "failed"));
    case OutcomeKind::server_stopped:
    case OutcomeKind::paused:
    case OutcomeKind::not_started:
      return store_.requeue(lease, {outcome.reason, outcome.message}, outcome.end, false);
    case OutcomeKind::lost:
      return try_again_or_fail(job, lease, outcome);
  }
  return api::Error{Fault::internal, "an attempt ended in no known way"};
}

api::Status JobService::succeed(const Job& job, const Lease& lease, const AttemptOutcome& outcome,
                                const std::atomic<bool>& stopping) {
  const std::filesystem::path folder = folder_.job(job.id);
  if (const auto excess = excess_of(job)) {
    record_bytes(job);
    return store_.fail(lease, {"limit_exceeded", "the worker left " + *excess}, outcome.end, {});
  }
  // Only a job that has succeeded has views and videos: whatever lies there now was planted, to be served.
  for (const char* part : {"views", "videos"})
    if (api::Status removed = remove_tree(folder / part); !removed) return removed;
  const auto results = collect_results(folder, job.frame_count, stopping);
  if (!results && results.error().fault == Fault::stopped) return results.error();
  // Want of descriptors, say, is nobody's lie, and passes.
  if (!results && results.error().fault == Fault::internal && outcome.looks_left > 0) return results.error();
  if (results) forget_checkpoint(job);
  record_bytes(job);
  api::fault_point("results_collected");
  api::Status kept = results ? store_.succeed(lease, *results, report_text(read_report(folder), "succeeded"))
                             : api::Status(results.error());
  api::fault_point("results_committed");
  if (kept) return kept;
  const Fault fault = kept.error().fault;
  // Neither says anything about the worker. Whatever else does not go into the store never will: it must end
  // the attempt like any other lie, or the job would stay `running` for ever.
  if (results && (fault == Fault::wrong_state || fault == Fault::disk_full)) return kept;
  AttemptOutcome lied = outcome;
  lied.kind = OutcomeKind::lost;
  lied.reason = "bad_artefacts";
  lied.message = "the worker said it was done, but " + kept.error().message;
  return try_again_or_fail(job, lease, lied);
}

api::Status JobService::wait_for_room_or_fail(const Job& job, const Lease& lease,
                                              const AttemptOutcome& outcome) {
  const auto earlier = store_.count_attempts(lease.job_seq, outcome.reason);
  if (!earlier) return earlier.error();
  // What it has written is part of what fills the disk. The checkpoint, which can be used again, goes only
  // where there is no room without it: jobs that each keep theirs must not wait for each other.
  const api::Status removed = remove_tree(folder_.job(job.id) / "artefacts");
  if (!removed) log_line(job.id + ": " + removed.error().message);
  if (!has_room(folder_.jobs())) forget_checkpoint(job);
  record_bytes(job);
  const std::string message = with_log(outcome);
  if (*earlier + 1 >= rules_.disk_full_attempts_max)
    return store_.fail(
        lease, {outcome.reason, "given up after " + std::to_string(*earlier + 1) + " attempts: " + message},
        outcome.end, report_text(read_report(folder_.job(job.id)), "failed"));
  std::int64_t wait_ms = rules_.disk_full_wait_ms;
  for (std::int64_t i = 0; i < *earlier && wait_ms < rules_.disk_full_wait_ms_max; ++i) wait_ms *= 2;
  return store_.requeue(lease, {outcome.reason, message}, outcome.end, false,
                        clock_() + std::min(wait_ms, rules_.disk_full_wait_ms_max));
}

api::Status JobService::try_again_or_fail(const Job& job, const Lease& lease, const AttemptOutcome& outcome) {
  const StepReason why{outcome.reason, with_log(outcome)};
  // A job that is to pause does so, whatever its worker died of.
  if (job.state == JobState::pause_requested) return store_.requeue(lease, why, outcome.end, true);
  if (job.attempts_without_progress < rules_.attempts_without_progress_max)
    return store_.requeue(lease, why, outcome.end, true);
  const StepReason final{outcome.reason,
                         "given up after " + std::to_string(job.attempt) + " attempts: " + why.message};
  return store_.fail(lease, final, outcome.end, report_text(read_report(folder_.job(job.id)), "failed"));
}

api::Status JobService::take_up_again(const Orphan& orphan) {
  api::Status taken = settle_orphan(orphan);
  tell_change();
  return taken;
}

api::Status JobService::settle_orphan(const Orphan& orphan) {
  if (orphan.job.state == JobState::cancel_requested) return store_.finish_cancel(orphan.lease, {});
  if (orphan.job.state == JobState::pause_requested)
    return store_.requeue(orphan.lease, {"paused", "on request"}, {}, false);
  // No attempt of three: most likely the server's end says nothing about the job, which runs in a process of
  // its own. But a job that takes the machine down must not do so for ever.
  const auto earlier = store_.count_attempts(orphan.lease.job_seq, kServerRestarted);
  if (!earlier) return earlier.error();
  const std::string why = "the server ended while the job was running";
  if (*earlier + 1 >= rules_.orphaned_attempts_max)
    return store_.fail(
        orphan.lease,
        {kServerRestarted, "given up after " + std::to_string(*earlier + 1) + " attempts: " + why}, {}, {});
  return store_.requeue(orphan.lease, {kServerRestarted, why}, {}, false);
}

}  // namespace server
