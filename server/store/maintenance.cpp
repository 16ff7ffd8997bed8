#include "server/store/maintenance.h"

#include <sqlite3.h>

#include <memory>

namespace server {
namespace {

constexpr int kAllPages = -1;
constexpr int kWaitMs = 20;
constexpr int kTriesMax = 500;
constexpr std::size_t kDamageMax = 100;

struct CloseFile {
  void operator()(sqlite3* handle) const { sqlite3_close(handle); }
};
using Handle = std::unique_ptr<sqlite3, CloseFile>;

api::Result<Handle> open_handle(const std::filesystem::path& file, int flags) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &raw, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  Handle handle(raw);
  if (code != SQLITE_OK)
    return sqlite_error(code, file.string() + ": " + (raw ? sqlite3_errmsg(raw) : "no memory"));
  sqlite3_busy_timeout(raw, 5000);
  return api::Result<Handle>(std::move(handle));
}

}  // namespace

api::Status copy_database(const std::filesystem::path& from, const std::filesystem::path& to) {
  auto source = open_handle(from, SQLITE_OPEN_READONLY);
  if (!source) return source.error();
  auto target = open_handle(to, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_EXRESCODE);
  if (!target) return target.error();
  sqlite3_backup* backup = sqlite3_backup_init(target->get(), "main", source->get(), "main");
  if (!backup) return sqlite_error(sqlite3_errcode(target->get()), sqlite3_errmsg(target->get()));
  int code = SQLITE_OK;
  // In one step: between two of them every commit of others would make it begin again, for ever where they
  // are busy. It reads what was there at its begin, and keeps nobody from writing.
  for (int tries = 0; tries < kTriesMax; ++tries) {
    code = sqlite3_backup_step(backup, kAllPages);
    if (code != SQLITE_BUSY && code != SQLITE_LOCKED) break;
    sqlite3_sleep(kWaitMs);
  }
  (void)sqlite3_backup_finish(backup);
  if (code != SQLITE_DONE) return sqlite_error(code, sqlite3_errstr(code));
  // The copy says WAL of itself, as the original does; written so, it stays a single file.
  code = sqlite3_exec(target->get(), "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return sqlite_error(code, sqlite3_errmsg(target->get()));
  return api::Done{};
}

api::Result<std::vector<std::string>> damage_of(Database& database) {
  std::vector<std::string> damage;
  Statement whole = database.prepare("PRAGMA integrity_check(100)");
  while (damage.size() < kDamageMax && whole.next())
    if (whole.text(0) != "ok") damage.push_back("database: " + whole.text(0));
  // A badly damaged file is told of by an error instead of rows.
  if (const api::Status ok = whole.status(); !ok) damage.push_back("database: " + ok.error().message);
  Statement keys = database.prepare("PRAGMA foreign_key_check");
  while (damage.size() < kDamageMax && keys.next())
    damage.push_back("database: a row of " + keys.text(0) + " refers to a row that is gone");
  if (const api::Status ok = keys.status(); !ok && damage.empty())
    damage.push_back("database: " + ok.error().message);
  return damage;
}

namespace {

constexpr std::string_view kArtefacts =
    "SELECT job_seq, job.id, artefact.path, artefact.bytes, artefact.sha256 FROM artefact "
    "JOIN job ON job.seq = job_seq WHERE removing = 0 AND (job_seq, artefact.path) > (?, ?) "
    "ORDER BY job_seq, artefact.path LIMIT ?";
constexpr std::string_view kInputs =
    "SELECT job_seq, job.id, job_input.name, job_input.bytes, job_input.sha256 FROM job_input "
    "JOIN job ON job.seq = job_seq WHERE removing = 0 AND (job_seq, job_input.name) > (?, ?) "
    "AND job_input.sha256 IS NOT NULL ORDER BY job_seq, job_input.name LIMIT ?";

}  // namespace

api::Result<std::vector<KeptFile>> kept_files(Database& database) {
  auto files = kept_files_after(database, false, 0, "", -1);  // SQLite takes a negative limit for none
  if (!files) return files;
  // A backup may be of before inputs had hashes.
  Statement known = database.prepare("SELECT 1 FROM pragma_table_info('job_input') WHERE name = 'sha256'");
  const bool has_hashes = known.next();
  if (const api::Status ok = known.status(); !ok) return ok.error();
  if (!has_hashes) return files;
  const auto inputs = kept_files_after(database, true, 0, "", -1);
  if (!inputs) return inputs.error();
  files->insert(files->end(), inputs->begin(), inputs->end());
  return files;
}

api::Result<std::vector<KeptFile>> kept_files_after(Database& database, bool inputs, std::int64_t after_seq,
                                                    std::string_view after_path, std::int64_t limit) {
  Statement select = database.prepare(inputs ? kInputs : kArtefacts);
  select.bind(after_seq).bind(after_path).bind(limit);
  std::vector<KeptFile> files;
  while (select.next())
    files.push_back(
        {select.integer(0), select.text(1), select.text(2), select.integer(3), select.text(4), inputs});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return files;
}

api::Result<std::vector<std::string>> kept_blobs(Database& database) {
  std::vector<std::string> hashes;
  Statement known = database.prepare("SELECT 1 FROM sqlite_schema WHERE name = 'blob'");
  const bool has_blobs = known.next();
  if (const api::Status ok = known.status(); !ok) return ok.error();
  if (!has_blobs) return hashes;
  Statement select = database.prepare("SELECT DISTINCT sha256 FROM blob ORDER BY sha256");
  while (select.next()) hashes.push_back(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return hashes;
}

api::Result<std::vector<KeptJob>> kept_jobs(Database& database) {
  Statement select =
      database.prepare("SELECT id, state = 'succeeded' FROM job WHERE removing = 0 ORDER BY seq");
  std::vector<KeptJob> jobs;
  while (select.next()) jobs.push_back({select.text(0), select.integer(1) != 0});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return jobs;
}

api::Result<bool> is_kept(Database& database, const std::string& id) {
  Statement select = database.prepare("SELECT 1 FROM job WHERE id = ? AND removing = 0");
  const bool kept = select.bind(id).next();
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return kept;
}

api::Result<std::vector<KeptInput>> kept_inputs(Database& database) {
  Statement select = database.prepare(
      "SELECT job.id, job_input.name, job_input.bytes FROM job_input JOIN job ON job.seq = job_seq "
      "WHERE removing = 0 ORDER BY job_seq, job_input.name");
  std::vector<KeptInput> inputs;
  while (select.next()) inputs.push_back({select.text(0), select.text(1), select.integer(2)});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return inputs;
}

api::Status end_attempts_of_copy(Database& database, std::int64_t now_ms) {
  const std::string now = std::to_string(now_ms);
  const std::string under_way = " WHERE state IN ('running', 'pause_requested', 'cancel_requested')";
  const std::string next =
      "CASE state WHEN 'running' THEN 'queued' WHEN 'pause_requested' THEN 'paused' ELSE 'canceled' END";
  const std::string why = "'restored', 'it was under way when this copy of the data was made'";
  Transaction transaction(database);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  // Columns of the first schema only: the copy may be of a database that this version has not migrated yet.
  for (const std::string& script :
       {std::string("UPDATE attempt SET worker_pid = NULL, worker_start_ticks = NULL, worker_boot_id = NULL"),
        "UPDATE attempt SET ended_ms = " + now + ", outcome = 'restored' WHERE ended_ms IS NULL",
        "INSERT INTO event(job_seq, at_ms, from_state, to_state, reason, message) SELECT seq, " + now +
            ", state, " + next + ", " + why + " FROM job" + under_way,
        "UPDATE job SET state = " + next + ", finished_ms = CASE WHEN state = 'cancel_requested' THEN " +
            now + " END, (reason, message) = (" + why + "), version = version + 1, updated_ms = " + now +
            ", best_fraction = max(best_fraction, fraction), stage = NULL, stage_fraction = 0, fraction = 0, "
            "progress_message = '', attempts_without_progress = max(0, attempts_without_progress - 1)" +
            under_way})
    if (api::Status done = database.execute(script); !done) return done;
  return transaction.commit();
}

api::Status forget_job(Database& database, const std::string& id) {
  Statement erase = database.prepare("DELETE FROM job WHERE id = ?");
  return erase.bind(id).run();
}

}  // namespace server
