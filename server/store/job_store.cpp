#include "server/store/job_store.h"

#include <chrono>
#include <utility>

#include "server/store/migrate.h"
#include "server/store/read_rows.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

api::Error no_such_job(std::string_view id) {
  return {Fault::not_found, "there is no job '" + std::string(id) + "'"};
}

}  // namespace

std::int64_t system_clock_ms() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
}

api::Result<std::unique_ptr<JobStore>> JobStore::open(const std::filesystem::path& file, Clock clock) {
  auto database = Database::open(file);
  if (!database) return database.error();
  if (const api::Status whole = check_integrity(*database); !whole) return whole.error();
  if (const api::Status migrated = migrate(*database); !migrated) return migrated.error();
  return std::unique_ptr<JobStore>(new JobStore(std::move(*database), std::move(clock)));
}

// The one place where a job changes its state. Inside the caller's transaction.
api::Status JobStore::step(const Step& step) {
  const std::int64_t now = clock_();
  Statement update = database_.prepare(
      "UPDATE job SET state = ?, reason = ?, message = ?, version = version + 1, updated_ms = ?, "
      "finished_ms = ? WHERE seq = ? AND state = ?");
  update.bind(api::name_of(step.to)).bind(step.why.reason).bind(step.why.message).bind(now);
  if (api::is_final(step.to))
    update.bind(now);
  else
    update.bind_null();
  update.bind(step.seq).bind(api::name_of(step.from));
  if (api::Status done = update.run(); !done) return done;
  if (database_.changes() != 1)
    return api::Error{Fault::wrong_state, "the job is no longer " + std::string(api::name_of(step.from))};

  Statement event = database_.prepare(
      "INSERT INTO event(job_seq, at_ms, from_state, to_state, reason, message) VALUES (?, ?, ?, ?, ?, ?)");
  event.bind(step.seq).bind(now).bind(api::name_of(step.from)).bind(api::name_of(step.to));
  return event.bind(step.why.reason).bind(step.why.message).run();
}

api::Result<Job> JobStore::insert(const NewJob& job) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  const std::int64_t now = clock_();
  std::int64_t bytes = 0;
  for (const InputFile& input : job.inputs) bytes += input.bytes;

  Statement row = database_.prepare(
      "INSERT INTO job(id, name, state, frame_count, fps, input_bytes, created_ms, updated_ms) "
      "VALUES (?, ?, 'queued', ?, ?, ?, ?, ?)");
  row.bind(job.id).bind(job.name).bind(std::int64_t{job.frame_count}).bind(job.fps).bind(bytes);
  if (const api::Status done = row.bind(now).bind(now).run(); !done) return done.error();
  const std::int64_t seq = database_.last_row();

  Statement input_row =
      database_.prepare("INSERT INTO job_input(job_seq, name, role, bytes) VALUES (?, ?, ?, ?)");
  for (const InputFile& input : job.inputs) {
    input_row.bind(seq).bind(input.name).bind(name_of(input.role)).bind(input.bytes);
    if (const api::Status done = input_row.run(); !done) return done.error();
    input_row.reset();
  }

  Statement event = database_.prepare(
      "INSERT INTO event(job_seq, at_ms, to_state, reason, message) VALUES (?, ?, 'queued', 'submitted', "
      "'')");
  if (const api::Status done = event.bind(seq).bind(now).run(); !done) return done.error();
  // Read before the commit: once that is done, nothing may make the caller believe that there is no job.
  auto inserted = job_locked(job.id);
  if (!inserted) return inserted;
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return inserted;
}

api::Result<Job> JobStore::job_locked(std::string_view id) {
  Statement select = database_.prepare(select_jobs(Reports::read) + "WHERE id = ? AND removing = 0");
  select.bind(id);
  if (select.next()) return read_job(select);
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return no_such_job(id);
}

api::Result<Job> JobStore::job(std::string_view id) {
  const std::lock_guard lock(mutex_);
  return job_locked(id);
}

api::Result<std::vector<Job>> JobStore::list(std::optional<JobState> state,
                                             std::optional<std::int64_t> before_seq, std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare(select_jobs(Reports::left_out) + "WHERE removing = 0 AND seq < ?" +
                                       (state ? " AND state = ?" : "") + " ORDER BY seq DESC LIMIT ?");
  select.bind(before_seq.value_or(INT64_MAX));
  if (state) select.bind(api::name_of(*state));
  select.bind(limit);
  std::vector<Job> jobs;
  while (select.next()) jobs.push_back(read_job(select));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return jobs;
}

api::Result<std::int64_t> JobStore::count(JobState state) {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT count(*) FROM job WHERE state = ? AND removing = 0");
  select.bind(api::name_of(state));
  const std::int64_t count = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return count;
}

api::Result<Job> JobStore::cancel(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  const auto job = job_locked(id);
  if (!job) return job;
  // Asking twice is no error: the second request may be the first one's repetition.
  if (job->state == JobState::cancel_requested || job->state == JobState::canceled) return job;

  const JobState to = job->state == JobState::queued ? JobState::canceled : JobState::cancel_requested;
  if (!api::may_step(job->state, to))
    return api::Error{Fault::wrong_state,
                      "the job is " + std::string(api::name_of(job->state)) + " and cannot be canceled"};
  const api::Status stepped = step({job->seq, job->state, to, {"canceled", "on request"}});
  if (!stepped) return stepped.error();
  auto canceled = job_locked(id);
  if (!canceled) return canceled;
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return canceled;
}

api::Status JobStore::begin_removal(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement begun = database_.prepare("SELECT 1 FROM job WHERE id = ? AND removing = 1");
  if (begun.bind(id).next()) return api::Done{};
  if (api::Status ok = begun.status(); !ok) return ok;
  const auto job = job_locked(id);
  if (!job) return job.error();
  if (!api::is_final(job->state))
    return api::Error{Fault::wrong_state, "the job is " + std::string(api::name_of(job->state)) +
                                              "; cancel it first, then remove it"};
  Statement mark = database_.prepare("UPDATE job SET removing = 1, version = version + 1 WHERE seq = ?");
  return mark.bind(job->seq).run();
}

api::Status JobStore::erase(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement erase = database_.prepare("DELETE FROM job WHERE id = ? AND removing = 1");
  return erase.bind(id).run();
}

api::Result<std::vector<std::string>> JobStore::jobs_being_removed() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT id FROM job WHERE removing = 1");
  std::vector<std::string> ids;
  while (select.next()) ids.push_back(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return ids;
}

api::Result<std::vector<std::string>> JobStore::all_ids() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT id FROM job");
  std::vector<std::string> ids;
  while (select.next()) ids.push_back(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return ids;
}

}  // namespace server
