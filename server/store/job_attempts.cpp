// The part of JobStore that the supervisor uses: one attempt, from claim to end, fenced by its lease.
#include "api/fault_point.h"
#include "server/store/job_store.h"
#include "server/store/read_rows.h"

namespace server {
namespace {

using api::Fault;
using api::JobEvent;
using api::JobState;

/// An attempt has made progress when it came this much further than every earlier one. Not any amount: a job
/// that crashes at nearly the same place each time must not go on for ever.
constexpr double kProgressStep = 0.05;

api::Error superseded() {
  return {Fault::wrong_state, "another attempt of this job has begun, or it has ended"};
}

}  // namespace

api::Status JobStore::record_worker(const Lease& lease, const ProcessIdentity& worker) {
  api::fault_point("worker_started");
  const std::lock_guard lock(mutex_);
  Statement update = database_.prepare(
      "UPDATE attempt SET worker_pid = ?, worker_start_ticks = ?, worker_boot_id = ? "
      "WHERE job_seq = ? AND lease = ? AND ended_ms IS NULL");
  update.bind(worker.pid).bind(worker.start_ticks).bind(worker.boot_id).bind(lease.job_seq).bind(lease.token);
  if (api::Status done = update.run(); !done) return done;
  if (database_.changes() != 1) return superseded();
  api::fault_point("worker_recorded");
  return api::Done{};
}

api::Result<JobState> JobStore::record_progress(const Lease& lease, const api::ProgressLine& line) {
  const std::lock_guard lock(mutex_);
  Statement update = database_.prepare(
      "UPDATE job SET stage = ?, stage_fraction = ?, fraction = max(fraction, ?), progress_message = ?, "
      "seconds_left = ?, "
      "attempts_without_progress = CASE WHEN attempt > 1 AND ? >= best_fraction + ? THEN 0 "
      "ELSE attempts_without_progress END, "
      "forgiven_attempt = CASE WHEN attempt > 1 AND ? >= best_fraction + ? THEN attempt - 1 "
      "ELSE forgiven_attempt END, updated_ms = ?, version = version + 1 "
      "WHERE seq = ? AND lease = ? AND state IN ('running', 'cancel_requested') RETURNING state");
  update.bind(api::name_of(line.stage)).bind(line.stage_fraction).bind(line.fraction).bind(line.message);
  update.bind_optional(line.seconds_left);
  update.bind(line.fraction)
      .bind(kProgressStep)
      .bind(line.fraction)
      .bind(kProgressStep)
      .bind(clock_())
      .bind(lease.job_seq)
      .bind(lease.token);
  const std::string state = update.next() ? update.text(0) : "";
  if (const api::Status done = update.run(); !done) return done.error();
  const auto known = api::job_state_named(state);
  if (!known) return superseded();
  return *known;
}

api::Result<Job> JobStore::leased_job_in(Database& database, const Lease& lease) {
  Statement select = database.prepare(select_jobs(Reports::read) +
                                      "WHERE seq = ? AND lease = ? "
                                      "AND state IN ('running', 'pause_requested', 'cancel_requested')");
  select.bind(lease.job_seq).bind(lease.token);
  if (select.next()) return read_job(select);
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return superseded();
}

api::Result<Job> JobStore::leased_job(const Lease& lease) {
  Reading reading(*readers_);
  return leased_job_in(reading.database(), lease);
}

api::Status JobStore::end_attempt(const Lease& lease, std::string_view outcome, const AttemptEnd& end) {
  Statement update = database_.prepare(
      "UPDATE attempt SET ended_ms = ?, outcome = ?, exit_code = ?, signal = ? "
      "WHERE job_seq = ? AND lease = ? AND ended_ms IS NULL");
  update.bind(clock_()).bind(outcome);
  update.bind_optional(end.exit_code ? std::optional<std::int64_t>(*end.exit_code) : std::nullopt);
  update.bind_optional(end.signal ? std::optional<std::int64_t>(*end.signal) : std::nullopt);
  if (api::Status done = update.bind(lease.job_seq).bind(lease.token).run(); !done) return done;
  if (database_.changes() != 1) return superseded();
  return api::Done{};
}

// Whoever ends the attempt has not seen the wish to cancel yet: it has to look again.
api::Status JobStore::refuse_canceled(const Lease& lease) {
  const auto job = leased_job_in(database_, lease);
  if (!job) return job.error();
  if (job->state == JobState::cancel_requested)
    return api::Error{Fault::wrong_state, "the job is to be canceled"};
  return api::Done{};
}

// Common to every end of an attempt; inside the caller's transaction.
api::Status JobStore::leave_running(const Lease& lease, JobEvent event, const StepReason& why,
                                    const AttemptEnd& end, std::string_view report_json) {
  const auto job = leased_job_in(database_, lease);
  if (!job) return job.error();
  const auto to = api::after(job->state, event);
  if (!to) return superseded();
  const std::string_view outcome = why.reason.empty() ? api::name_of(*to) : std::string_view(why.reason);
  if (api::Status ended = end_attempt(lease, outcome, end); !ended) return ended;
  Statement keep = database_.prepare(
      "UPDATE job SET best_fraction = max(best_fraction, fraction), seconds_left = NULL, "
      "report = coalesce(?, report), run_ms = run_ms + coalesce(?, (SELECT max(0, job.updated_ms - "
      "attempt.started_ms) FROM attempt WHERE job_seq = seq AND number = job.attempt), 0) WHERE seq = ?");
  if (report_json.empty())
    keep.bind_null();
  else
    keep.bind(report_json);
  keep.bind_optional(end.ran_ms);
  if (api::Status kept = keep.bind(lease.job_seq).run(); !kept) return kept;
  return step({lease.job_seq, job->state, *to, why});
}

api::Status JobStore::succeed(const Lease& lease, const Results& results, std::string_view report_json) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  if (const api::Status wanted = refuse_canceled(lease); !wanted) return wanted;
  if (api::Status left = leave_running(lease, JobEvent::done, {}, {0, std::nullopt}, report_json); !left)
    return left;
  if (api::Status kept = insert_results(lease.job_seq, results); !kept) return kept;
  Statement whole = database_.prepare(
      "UPDATE job SET fraction = 1, stage_fraction = 1, "
      "key_frame_count = (SELECT nullif(count(*), 0) FROM frame WHERE job_seq = seq AND kind = 'key'), "
      "solved_frame_count = (SELECT nullif(count(*), 0) FROM frame "
      "WHERE job_seq = seq AND kind <> 'interpolated') WHERE seq = ?");
  if (api::Status done = whole.bind(lease.job_seq).run(); !done) return done;
  return transaction.commit();
}

api::Status JobStore::fail(const Lease& lease, const StepReason& why, const AttemptEnd& end,
                           std::string_view report_json) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  if (const api::Status wanted = refuse_canceled(lease); !wanted) return wanted;
  if (api::Status left = leave_running(lease, JobEvent::gave_up, why, end, report_json); !left) return left;
  return transaction.commit();
}

api::Status JobStore::requeue(const Lease& lease, const StepReason& why, const AttemptEnd& end, bool counted,
                              std::int64_t not_before_ms) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  if (const api::Status wanted = refuse_canceled(lease); !wanted) return wanted;
  if (api::Status left = leave_running(lease, JobEvent::interrupted, why, end, {}); !left) return left;
  // A paused job still shows how far it had come.
  Statement wait = database_.prepare(
      "UPDATE job SET not_before_ms = ?, attempts_without_progress = max(0, attempts_without_progress - ?) "
      "WHERE seq = ?");
  wait.bind(not_before_ms).bind(std::int64_t{counted ? 0 : 1}).bind(lease.job_seq);
  if (api::Status done = wait.run(); !done) return done;
  Statement progress = database_.prepare(
      "UPDATE job SET stage = NULL, stage_fraction = 0, fraction = 0, progress_message = '' "
      "WHERE seq = ? AND state = 'queued'");
  if (api::Status done = progress.bind(lease.job_seq).run(); !done) return done;
  return transaction.commit();
}

api::Status JobStore::finish_cancel(const Lease& lease, const AttemptEnd& end) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  const auto job = leased_job_in(database_, lease);
  if (!job) return job.error();
  if (job->state != JobState::cancel_requested) return superseded();
  const StepReason why{"canceled", "on request"};
  if (api::Status left = leave_running(lease, JobEvent::interrupted, why, end, {}); !left) return left;
  return transaction.commit();
}

api::Result<std::int64_t> JobStore::count_attempts(std::int64_t job_seq, std::string_view reason) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT count(*) FROM attempt JOIN job ON seq = job_seq "
      "WHERE job_seq = ? AND outcome = ? AND number > forgiven_attempt");
  select.bind(job_seq).bind(reason);
  const std::int64_t count = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return count;
}

api::Result<std::vector<Orphan>> JobStore::orphans() {
  Reading reading(*readers_);
  std::vector<Orphan> orphans;
  Statement jobs = reading.prepare(select_jobs(Reports::left_out) +
                                   "WHERE state IN ('running', 'pause_requested', 'cancel_requested') "
                                   "ORDER BY seq");
  while (jobs.next()) orphans.push_back({read_job(jobs), {}, std::nullopt});
  if (const api::Status ok = jobs.status(); !ok) return ok.error();

  Statement worker = reading.prepare(
      "SELECT attempt.lease, worker_pid, worker_start_ticks, worker_boot_id FROM attempt JOIN job ON seq = "
      "job_seq "
      "WHERE seq = ? AND number = job.attempt");
  for (Orphan& orphan : orphans) {
    if (worker.bind(orphan.job.seq).next()) {
      orphan.lease = {orphan.job.seq, worker.integer(0)};
      if (!worker.is_null(1))
        orphan.worker = ProcessIdentity{worker.integer(1), worker.integer(2), worker.text(3)};
    }
    if (const api::Status ok = worker.status(); !ok) return ok.error();
    worker.reset();
  }
  return orphans;
}

api::Status JobStore::forget_waiting_times() {
  const std::lock_guard lock(mutex_);
  return database_.execute("UPDATE job SET not_before_ms = 0 WHERE state = 'queued'");
}

}  // namespace server
