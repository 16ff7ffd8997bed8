// The part of JobStore that remembers which files are no longer what they were.
#include "server/store/job_store.h"

namespace server {

api::Error damaged_file(std::string_view path, std::string_view detail) {
  return {api::Fault::internal,
          "the file was damaged on the disk of the service after it was made: " + std::string(detail) +
              "; run the job again, or have a backup restored",
          {{std::string(path), "", 0, 0, std::string(kDamagedFile), std::string(detail)}}};
}

api::Status JobStore::must_be_whole(std::int64_t job_seq, std::string_view glob) {
  const std::lock_guard lock(mutex_);
  Statement select =
      database_.prepare("SELECT path, detail FROM damage WHERE job_seq = ? AND path GLOB ? LIMIT 1");
  select.bind(job_seq).bind(glob);
  if (select.next()) return damaged_file(select.text(0), select.text(1));
  return select.status();
}

api::Status JobStore::record_look(const FileLook& look) {
  const std::lock_guard lock(mutex_);
  if (look.detail.empty()) {
    Statement whole = database_.prepare("DELETE FROM damage WHERE job_seq = ? AND path = ?");
    return whole.bind(look.job_seq).bind(look.path).run();
  }
  // The job may have been removed meanwhile.
  Statement damaged = database_.prepare(
      "INSERT INTO damage(job_seq, path, detail, found_ms) SELECT job_seq, path, ?, ? FROM artefact "
      "WHERE job_seq = ? AND path = ? ON CONFLICT DO UPDATE SET detail = excluded.detail");
  return damaged.bind(look.detail).bind(clock_()).bind(look.job_seq).bind(look.path).run();
}

api::Result<std::int64_t> JobStore::count_damaged() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT count(*) FROM damage");
  const std::int64_t count = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return count;
}

api::Result<IntegrityState> JobStore::integrity() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT ended_ms, round_ms, after_seq, after_path FROM integrity");
  IntegrityState state;
  if (select.next()) state = {select.integer(0), select.integer(1), select.integer(2), select.text(3)};
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return state;
}

api::Status JobStore::keep_integrity(const IntegrityState& state) {
  const std::lock_guard lock(mutex_);
  Statement update =
      database_.prepare("UPDATE integrity SET ended_ms = ?, round_ms = ?, after_seq = ?, after_path = ?");
  update.bind(state.ended_ms).bind(state.round_ms).bind(state.after_seq).bind(state.after_path);
  return update.run();
}

}  // namespace server
