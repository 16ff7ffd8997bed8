// The part of JobStore that keeps account of what jobs take on disk, and lets them go.
#include "server/store/job_store.h"
#include "server/store/read_rows.h"

namespace server {
namespace {

api::Result<std::vector<std::string>> ids_of(Statement& select) {
  std::vector<std::string> ids;
  while (select.next()) ids.push_back(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return ids;
}

}  // namespace

api::Status JobStore::begin_removal(std::string_view id, RemovalOf kind) {
  const std::lock_guard lock(mutex_);
  Statement begun = database_.prepare("SELECT 1 FROM job WHERE id = ? AND removing = 1");
  if (begun.bind(id).next()) return api::Done{};
  if (api::Status ok = begun.status(); !ok) return ok;
  const auto job = job_in(database_, id);
  if (!job) return job.error();
  if (!api::is_final(job->state))
    return api::Error{api::Fault::wrong_state, "the job is " + std::string(api::name_of(job->state)) +
                                                   "; cancel it first, then remove it"};
  Transaction transaction(database_);
  if (api::Status opened = transaction.begin(); !opened) return opened;
  // Looked at again in the same breath: whoever chose the job did so a moment ago.
  Statement mark = database_.prepare(
      "UPDATE job SET removing = 1, version = version + 1 WHERE seq = ? AND (? OR pinned = 0) AND "
      "(? OR coalesce(expires_ms <= ?, 0))");
  mark.bind(job->seq).bind(std::int64_t{kind == RemovalOf::any});
  mark.bind(std::int64_t{kind != RemovalOf::expired}).bind(clock_());
  if (api::Status done = mark.run(); !done) return done;
  if (database_.changes() != 1) return api::Error{api::Fault::wrong_state, "the job is to be kept"};
  if (api::Status told = leave_word(*job); !told) return told;
  return transaction.commit();
}

// The row takes its events with it, so this one is kept apart; its number is one of theirs.
api::Status JobStore::leave_word(const Job& job) {
  constexpr std::int64_t kToldForEvents = 1'000'000;
  const std::int64_t now = clock_();
  Statement event = database_.prepare(
      "INSERT INTO event(job_seq, at_ms, from_state, to_state, reason, message) "
      "VALUES (?, ?, ?, 'removed', '', '')");
  event.bind(job.seq).bind(now).bind(api::name_of(job.state));
  if (api::Status done = event.run(); !done) return done;
  const std::int64_t id = database_.last_row();
  Statement number_taken = database_.prepare("DELETE FROM event WHERE id = ?");
  if (api::Status done = number_taken.bind(id).run(); !done) return done;
  Statement row = database_.prepare(
      "INSERT INTO removal(event_id, at_ms, job_seq, job_id, owner, from_state) VALUES (?, ?, ?, ?, ?, ?)");
  row.bind(id).bind(now).bind(job.seq).bind(job.id).bind(job.owner).bind(api::name_of(job.state));
  if (api::Status done = row.run(); !done) return done;
  Statement old = database_.prepare("DELETE FROM removal WHERE event_id <= ?");
  return old.bind(id - kToldForEvents).run();
}

api::Status JobStore::erase(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement erase = database_.prepare("DELETE FROM job WHERE id = ? AND removing = 1");
  return erase.bind(id).run();
}

api::Result<std::vector<std::string>> JobStore::jobs_being_removed() {
  Reading reading(*readers_);
  Statement select = reading.prepare("SELECT id FROM job WHERE removing = 1");
  return ids_of(select);
}

api::Result<std::vector<std::string>> JobStore::all_ids() {
  Reading reading(*readers_);
  Statement select = reading.prepare("SELECT id FROM job");
  return ids_of(select);
}

api::Result<std::vector<std::string>> JobStore::expired(std::int64_t limit) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT id FROM job INDEXED BY job_expiry WHERE expires_ms IS NOT NULL AND expires_ms <= ? "
      "AND pinned = 0 ORDER BY expires_ms LIMIT ?");
  select.bind(clock_()).bind(limit);
  return ids_of(select);
}

api::Status JobStore::record_bytes(std::int64_t job_seq, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  Statement update =
      database_.prepare("UPDATE job SET bytes = ?, version = version + 1 WHERE seq = ? AND bytes <> ?");
  return update.bind(bytes).bind(job_seq).bind(bytes).run();
}

api::Result<std::vector<JobStore::Unused>> JobStore::least_used(std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  (void)keep_uses_locked();  // on a full disk room is to be made all the same
  Statement select = database_.prepare(
      "SELECT id, bytes FROM job INDEXED BY job_unused WHERE finished_ms IS NOT NULL AND pinned = 0 "
      "AND removing = 0 ORDER BY last_ms LIMIT ?");
  select.bind(limit);
  std::vector<Unused> jobs;
  while (select.next()) jobs.push_back({select.text(0), select.integer(1)});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return jobs;
}

api::Result<std::vector<Job>> JobStore::finished_after(std::int64_t seq, std::int64_t limit) {
  Reading reading(*readers_);
  Statement select =
      reading.prepare(select_jobs(Reports::left_out) +
                      "WHERE seq > ? AND finished_ms IS NOT NULL AND removing = 0 ORDER BY seq LIMIT ?");
  select.bind(seq).bind(limit);
  std::vector<Job> jobs;
  while (select.next()) jobs.push_back(read_job(select));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return jobs;
}

}  // namespace server
