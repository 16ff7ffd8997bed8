// The part of JobStore that knows whose blobs are whose.
#include "server/store/job_store.h"

namespace server {

api::Status JobStore::keep_blob(std::string_view owner, std::string_view sha256, std::int64_t bytes,
                                const Ceilings& most) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  if (api::Status room = admit_in(database_, owner, bytes, most); !room) return room;
  Statement row = database_.prepare(
      "INSERT INTO blob(owner, sha256, bytes, used_ms) VALUES (?, ?, ?, ?) "
      "ON CONFLICT(owner, sha256) DO UPDATE SET used_ms = excluded.used_ms");
  if (api::Status done = row.bind(owner).bind(sha256).bind(bytes).bind(clock_()).run(); !done) return done;
  return transaction.commit();
}

api::Result<std::int64_t> JobStore::forget_blobs(std::int64_t before_ms) {
  const std::lock_guard lock(mutex_);
  // What is not kept would be forgotten: room for a row less there may be where there is none for these.
  if (const api::Status kept = keep_uses_locked(); !kept) return kept.error();
  const std::int64_t now = clock_();
  // The wall clock may have jumped: nothing was used later than now.
  Statement mend = database_.prepare("UPDATE blob SET used_ms = ? WHERE used_ms > ?");
  if (const api::Status done = mend.bind(now).bind(now).run(); !done) return done.error();
  Statement erase = database_.prepare("DELETE FROM blob WHERE used_ms <= ?");
  if (const api::Status done = erase.bind(before_ms).run(); !done) return done.error();
  return static_cast<std::int64_t>(database_.changes());
}

api::Status JobStore::forget_blob(std::string_view sha256) {
  const std::lock_guard lock(mutex_);
  Statement erase = database_.prepare("DELETE FROM blob WHERE sha256 = ?");
  return erase.bind(sha256).run();
}

api::Result<std::set<std::string, std::less<>>> JobStore::blobs() {
  Reading reading(*readers_);
  Statement select = reading.prepare("SELECT DISTINCT sha256 FROM blob");
  std::set<std::string, std::less<>> hashes;
  while (select.next()) hashes.insert(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return hashes;
}

api::Result<std::int64_t> JobStore::blob_bytes(std::optional<std::string_view> owner) {
  Reading reading(*readers_);
  return blob_bytes_in(reading.database(), owner);
}

api::Result<std::int64_t> JobStore::blob_bytes_in(Database& database, std::optional<std::string_view> owner) {
  Statement select = database.prepare(std::string("SELECT coalesce(sum(bytes), 0) FROM blob") +
                                      (owner ? " WHERE owner = ?" : ""));
  if (owner) select.bind(*owner);
  const std::int64_t bytes = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return bytes;
}

}  // namespace server
