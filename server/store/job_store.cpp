#include "server/store/job_store.h"

#include <chrono>
#include <utility>

#include "server/store/migrate.h"
#include "server/store/read_rows.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

// Reading is work for the processor, mostly: more of them at once would not read faster.
constexpr std::size_t kReaders = 4;

}  // namespace

api::Error no_such_job(std::string_view id) {
  return {Fault::not_found, "there is no job '" + std::string(id) + "'"};
}

std::int64_t system_clock_ms() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
}

api::Result<std::unique_ptr<JobStore>> JobStore::open(const std::filesystem::path& file, Clock clock) {
  auto database = Database::open(file);
  if (!database) return database.error();
  if (const api::Status whole = check_integrity(*database); !whole) return whole.error();
  if (const api::Status migrated = migrate_file(*database, file); !migrated) return migrated.error();
  auto readers = ReadPool::open(file, kReaders);
  if (!readers) return readers.error();
  return std::unique_ptr<JobStore>(new JobStore(std::move(*database), std::move(*readers), std::move(clock)));
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

api::Status JobStore::insert_row(const NewJob& job, std::int64_t now) {
  std::int64_t bytes = 0;
  for (const InputFile& input : job.inputs) bytes += input.bytes;
  const JobSettings& settings = job.settings;
  Statement row = database_.prepare(
      "INSERT INTO job(id, owner, name, priority, deadline_ms, max_run_ms, ttl_ms, pinned, forecast, "
      "memory_bytes, frame_count, fps, input_bytes, bytes, state, queued_ms, created_ms, updated_ms) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 'queued', ?, ?, ?)");
  row.bind(job.id).bind(job.owner).bind(settings.name).bind(std::int64_t{settings.priority});
  row.bind_optional(settings.deadline_ms).bind_optional(settings.max_run_ms).bind_optional(settings.ttl_ms);
  row.bind(std::int64_t{settings.pinned});
  if (job.forecast)
    row.bind(api::forecast_json(*job.forecast));
  else
    row.bind_null();
  row.bind(static_cast<std::int64_t>(job.forecast ? job.forecast->memory_bytes : 0));
  row.bind(std::int64_t{job.frame_count}).bind(job.fps).bind(bytes).bind(bytes);
  return row.bind(now).bind(now).bind(now).run();
}

api::Status JobStore::insert_labels(std::int64_t seq, const api::Labels& labels) {
  Statement row = database_.prepare("INSERT INTO job_label(job_seq, name, value) VALUES (?, ?, ?)");
  for (const auto& [name, value] : labels) {
    if (api::Status done = row.bind(seq).bind(name).bind(value).run(); !done) return done;
    row.reset();
  }
  return api::Done{};
}

api::Status JobStore::read_labels(Database& database, std::span<Job> jobs) {
  Statement select = database.prepare("SELECT name, value FROM job_label WHERE job_seq = ?");
  for (Job& job : jobs) {
    select.bind(job.seq);
    while (select.next()) job.settings.labels[select.text(0)] = select.text(1);
    if (api::Status ok = select.status(); !ok) return ok;
    select.reset();
  }
  return api::Done{};
}

api::Result<Job> JobStore::insert(const NewJob& job, const Ceilings& most) {
  std::int64_t bytes = 0;
  for (const InputFile& input : job.inputs) bytes += input.bytes;
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  if (const api::Status room = admit_in(database_, job.owner, bytes, most); !room) return room.error();
  const std::int64_t now = clock_();
  if (const api::Status done = insert_row(job, now); !done) return done.error();
  const std::int64_t seq = database_.last_row();
  if (const api::Status done = insert_labels(seq, job.settings.labels); !done) return done.error();

  Statement input_row = database_.prepare(
      "INSERT INTO job_input(job_seq, name, role, bytes, sha256) VALUES (?, ?, ?, ?, nullif(?, ''))");
  for (const InputFile& input : job.inputs) {
    input_row.bind(seq).bind(input.name).bind(name_of(input.role)).bind(input.bytes).bind(input.sha256);
    if (const api::Status done = input_row.run(); !done) return done.error();
    input_row.reset();
  }
  if (job.key) {
    // Fails where there is one already; those that are too old to count have been forgotten before.
    Statement key = database_.prepare(
        "INSERT INTO idempotency_key(owner, key, job_seq, request_sha256, created_ms) VALUES (?, ?, ?, ?, "
        "?)");
    key.bind(job.owner).bind(job.key->key).bind(seq).bind(job.key->request_sha256);
    if (const api::Status done = key.bind(now).run(); !done) return done.error();
  }
  Statement event = database_.prepare(
      "INSERT INTO event(job_seq, at_ms, to_state, reason, message) VALUES (?, ?, 'queued', 'submitted', "
      "'')");
  if (const api::Status done = event.bind(seq).bind(now).run(); !done) return done.error();
  // Read before the commit: once that is done, nothing may make the caller believe that there is no job.
  auto inserted = job_in(database_, job.id);
  if (!inserted) return inserted;
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return inserted;
}

api::Result<Job> JobStore::job_in(Database& database, std::string_view id) {
  Statement select = database.prepare(select_jobs(Reports::read) + "WHERE id = ? AND removing = 0");
  select.bind(id);
  const bool found = select.next();
  if (const api::Status ok = select.status(); !ok) return ok.error();
  if (!found) return no_such_job(id);
  Job job = read_job(select);
  if (const api::Status labels = read_labels(database, {&job, 1}); !labels) return labels.error();
  return job;
}

api::Result<Job> JobStore::job(std::string_view id) {
  Reading reading(*readers_);
  return job_in(reading.database(), id);
}

api::Result<std::string> JobStore::owner_of(std::string_view id) {
  Reading reading(*readers_);
  Statement select = reading.prepare("SELECT owner FROM job WHERE id = ? AND removing = 0");
  select.bind(id);
  const bool found = select.next();
  if (const api::Status ok = select.status(); !ok) return ok.error();
  if (!found) return no_such_job(id);
  return select.text(0);
}

api::Result<std::vector<Job>> JobStore::list(const JobFilter& filter, std::int64_t limit) {
  Reading reading(*readers_);
  std::string where = "WHERE removing = 0 AND seq < ?";
  if (filter.state) where += " AND state = ?";
  for (const auto& owner : {filter.owner, filter.visible_to})
    if (owner) where += " AND owner = ?";
  for (const LabelFilter& label : filter.labels)
    where += std::string(" AND EXISTS (SELECT 1 FROM job_label WHERE job_seq = seq AND job_label.name = ?") +
             (label.value ? " AND value = ?)" : ")");
  Statement select = reading.prepare(select_jobs(Reports::left_out) + where + " ORDER BY seq DESC LIMIT ?");
  select.bind(filter.before_seq.value_or(INT64_MAX));
  if (filter.state) select.bind(api::name_of(*filter.state));
  for (const auto& owner : {filter.owner, filter.visible_to})
    if (owner) select.bind(*owner);
  for (const LabelFilter& label : filter.labels) {
    select.bind(label.name);
    if (label.value) select.bind(*label.value);
  }
  select.bind(limit);
  std::vector<Job> jobs;
  while (select.next()) jobs.push_back(read_job(select));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  if (const api::Status labels = read_labels(reading.database(), jobs); !labels) return labels.error();
  return jobs;
}

api::Result<std::int64_t> JobStore::count(JobState state) {
  Reading reading(*readers_);
  Statement select = reading.prepare("SELECT count(*) FROM job WHERE state = ? AND removing = 0");
  select.bind(api::name_of(state));
  const std::int64_t count = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return count;
}

}  // namespace server
