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
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT path, detail FROM damage WHERE job_seq = ?1 AND path GLOB ?2 UNION ALL "
      "SELECT 'input/' || name, detail FROM input_damage WHERE job_seq = ?1 AND 'input/' || name GLOB ?2 "
      "LIMIT 1");
  select.bind(job_seq).bind(glob);
  if (select.next()) return damaged_file(select.text(0), select.text(1));
  return select.status();
}

api::Status JobStore::record_look(const FileLook& look) {
  const std::lock_guard lock(mutex_);
  if (look.detail.empty()) {
    Statement whole =
        database_.prepare(look.is_input ? "DELETE FROM input_damage WHERE job_seq = ? AND name = ?"
                                        : "DELETE FROM damage WHERE job_seq = ? AND path = ?");
    return whole.bind(look.job_seq).bind(look.path).run();
  }
  // The job may have been removed meanwhile.
  Statement damaged = database_.prepare(
      look.is_input
          ? "INSERT INTO input_damage(job_seq, name, detail, found_ms) SELECT job_seq, name, ?, ? "
            "FROM job_input WHERE job_seq = ? AND name = ? ON CONFLICT DO UPDATE SET detail = excluded.detail"
          : "INSERT INTO damage(job_seq, path, detail, found_ms) SELECT job_seq, path, ?, ? FROM artefact "
            "WHERE job_seq = ? AND path = ? ON CONFLICT DO UPDATE SET detail = excluded.detail");
  return damaged.bind(look.detail).bind(clock_()).bind(look.job_seq).bind(look.path).run();
}

api::Result<std::int64_t> JobStore::count_damaged() {
  Reading reading(*readers_);
  Statement select =
      reading.prepare("SELECT (SELECT count(*) FROM damage) + (SELECT count(*) FROM input_damage)");
  const std::int64_t count = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return count;
}

api::Result<IntegrityState> JobStore::integrity() {
  Reading reading(*readers_);
  Statement select =
      reading.prepare("SELECT ended_ms, round_ms, at_inputs, after_seq, after_path FROM integrity");
  IntegrityState state;
  if (select.next())
    state = {select.integer(0), select.integer(1), select.integer(2) != 0, select.integer(3), select.text(4)};
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return state;
}

api::Status JobStore::keep_integrity(const IntegrityState& state) {
  const std::lock_guard lock(mutex_);
  Statement update = database_.prepare(
      "UPDATE integrity SET ended_ms = ?, round_ms = ?, at_inputs = ?, after_seq = ?, after_path = ?");
  update.bind(state.ended_ms).bind(state.round_ms).bind(std::int64_t{state.at_inputs});
  update.bind(state.after_seq).bind(state.after_path);
  return update.run();
}

}  // namespace server
