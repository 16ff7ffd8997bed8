// The part of JobStore that the supervisor uses: one attempt, from claim to end, fenced by its lease.
#include "server/store/job_store.h"
#include "server/store/read_rows.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

/// An attempt has made progress when it came this much further than every earlier one. Not any amount: a job
/// that crashes at nearly the same place each time must not go on for ever.
constexpr double kProgressStep = 0.05;

api::Error superseded() {
  return {Fault::wrong_state, "another attempt of this job has begun, or it has ended"};
}

}  // namespace

api::Result<std::optional<Claim>> JobStore::claim() {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  const std::int64_t now = clock_();
  // INDEXED BY: without it the planner may sort the whole queue for every claim.
  Statement oldest = database_.prepare(
      "SELECT seq, id FROM job INDEXED BY job_claim WHERE state = 'queued' AND not_before_ms <= ? "
      "ORDER BY seq LIMIT 1");
  if (!oldest.bind(now).next()) {
    if (const api::Status ok = oldest.status(); !ok) return ok.error();
    return std::optional<Claim>();
  }
  const std::int64_t seq = oldest.integer(0);
  const std::string id = oldest.text(1);
  oldest.reset();

  const api::Status stepped = step({seq, JobState::queued, JobState::running, {}});
  if (!stepped) return stepped.error();
  Statement lease = database_.prepare(
      "UPDATE job SET attempt = attempt + 1, attempts_without_progress = attempts_without_progress + 1, "
      "lease = lease + 1, started_ms = coalesce(started_ms, ?), stage = NULL, stage_fraction = 0, fraction = "
      "0, "
      "progress_message = '', seconds_left = NULL WHERE seq = ?");
  if (const api::Status done = lease.bind(now).bind(seq).run(); !done) return done.error();
  Statement attempt = database_.prepare(
      "INSERT INTO attempt(job_seq, number, lease, started_ms) SELECT seq, attempt, lease, ? FROM job "
      "WHERE seq = ? RETURNING lease");
  attempt.bind(now).bind(seq);
  const std::int64_t token = attempt.next() ? attempt.integer(0) : 0;
  if (const api::Status done = attempt.run(); !done) return done.error();

  const auto job = job_locked(id);
  if (!job) return job.error();
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return std::optional<Claim>(Claim{*job, Lease{seq, token}});
}

api::Status JobStore::record_worker(const Lease& lease, const ProcessIdentity& worker) {
  const std::lock_guard lock(mutex_);
  Statement update = database_.prepare(
      "UPDATE attempt SET worker_pid = ?, worker_start_ticks = ?, worker_boot_id = ? "
      "WHERE job_seq = ? AND lease = ? AND ended_ms IS NULL");
  update.bind(worker.pid).bind(worker.start_ticks).bind(worker.boot_id).bind(lease.job_seq).bind(lease.token);
  if (api::Status done = update.run(); !done) return done;
  if (database_.changes() != 1) return superseded();
  return api::Done{};
}

api::Result<JobState> JobStore::record_progress(const Lease& lease, const api::ProgressLine& line) {
  const std::lock_guard lock(mutex_);
  Statement update = database_.prepare(
      "UPDATE job SET stage = ?, stage_fraction = ?, fraction = max(fraction, ?), progress_message = ?, "
      "seconds_left = ?, "
      "attempts_without_progress = CASE WHEN attempt > 1 AND ? >= best_fraction + ? THEN 0 "
      "ELSE attempts_without_progress END, updated_ms = ?, version = version + 1 "
      "WHERE seq = ? AND lease = ? AND state IN ('running', 'cancel_requested') RETURNING state");
  update.bind(api::name_of(line.stage)).bind(line.stage_fraction).bind(line.fraction).bind(line.message);
  update.bind_optional(line.seconds_left);
  update.bind(line.fraction).bind(kProgressStep).bind(clock_()).bind(lease.job_seq).bind(lease.token);
  const std::string state = update.next() ? update.text(0) : "";
  if (const api::Status done = update.run(); !done) return done.error();
  const auto known = api::job_state_named(state);
  if (!known) return superseded();
  return *known;
}

api::Result<Job> JobStore::leased_job_locked(const Lease& lease) {
  Statement select = database_.prepare(select_jobs(Reports::read) +
                                       "WHERE seq = ? AND lease = ? "
                                       "AND state IN ('running', 'cancel_requested')");
  select.bind(lease.job_seq).bind(lease.token);
  if (select.next()) return read_job(select);
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return superseded();
}

api::Result<Job> JobStore::leased_job(const Lease& lease) {
  const std::lock_guard lock(mutex_);
  return leased_job_locked(lease);
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

// Common to every end of an attempt; inside the caller's transaction.
api::Status JobStore::leave_running(const Lease& lease, const Step& wanted, const AttemptEnd& end,
                                    std::string_view report_json) {
  if (const auto held = leased_job_locked(lease); !held) return held.error();
  const std::string_view outcome = wanted.why.reason.empty() ? api::name_of(wanted.to) : wanted.why.reason;
  if (api::Status ended = end_attempt(lease, outcome, end); !ended) return ended;
  Statement keep = database_.prepare(
      "UPDATE job SET best_fraction = max(best_fraction, fraction), seconds_left = NULL, "
      "report = coalesce(?, report) WHERE seq = ?");
  if (report_json.empty())
    keep.bind_null();
  else
    keep.bind(report_json);
  if (api::Status kept = keep.bind(lease.job_seq).run(); !kept) return kept;
  return step(wanted);
}

api::Status JobStore::succeed(const Lease& lease, const Results& results, std::string_view report_json) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  const Step wanted{lease.job_seq, JobState::running, JobState::succeeded, {}};
  if (api::Status left = leave_running(lease, wanted, {0, std::nullopt}, report_json); !left) return left;
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
  const Step wanted{lease.job_seq, JobState::running, JobState::failed, why};
  if (api::Status left = leave_running(lease, wanted, end, report_json); !left) return left;
  return transaction.commit();
}

api::Status JobStore::requeue(const Lease& lease, const StepReason& why, const AttemptEnd& end, bool counted,
                              std::int64_t not_before_ms) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  const Step wanted{lease.job_seq, JobState::running, JobState::queued, why};
  if (api::Status left = leave_running(lease, wanted, end, {}); !left) return left;
  Statement wait = database_.prepare(
      "UPDATE job SET not_before_ms = ?, attempts_without_progress = max(0, attempts_without_progress - ?), "
      "stage = NULL, stage_fraction = 0, fraction = 0, progress_message = '', seconds_left = NULL WHERE seq "
      "= ?");
  wait.bind(not_before_ms).bind(std::int64_t{counted ? 0 : 1}).bind(lease.job_seq);
  if (api::Status done = wait.run(); !done) return done;
  return transaction.commit();
}

api::Status JobStore::finish_cancel(const Lease& lease, const AttemptEnd& end) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  const StepReason why{"canceled", "on request"};
  const Step wanted{lease.job_seq, JobState::cancel_requested, JobState::canceled, why};
  if (api::Status left = leave_running(lease, wanted, end, {}); !left) return left;
  return transaction.commit();
}

api::Result<std::int64_t> JobStore::count_attempts(std::int64_t job_seq, std::string_view reason) {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT count(*) FROM attempt WHERE job_seq = ? AND outcome = ?");
  select.bind(job_seq).bind(reason);
  const std::int64_t count = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return count;
}

api::Result<std::vector<Orphan>> JobStore::orphans() {
  const std::lock_guard lock(mutex_);
  std::vector<Orphan> orphans;
  Statement jobs = database_.prepare(select_jobs(Reports::left_out) +
                                     "WHERE state IN ('running', 'cancel_requested') ORDER BY seq");
  while (jobs.next()) orphans.push_back({read_job(jobs), {}, std::nullopt});
  if (const api::Status ok = jobs.status(); !ok) return ok.error();

  Statement worker = database_.prepare(
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
