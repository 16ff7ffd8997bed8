// The part of JobStore that keeps account of what jobs take on disk, and lets them go.
#include "server/store/job_store.h"

namespace server {
namespace {

api::Result<std::vector<std::string>> ids_of(Statement& select) {
  std::vector<std::string> ids;
  while (select.next()) ids.push_back(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return ids;
}

}  // namespace

api::Status JobStore::begin_removal(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement begun = database_.prepare("SELECT 1 FROM job WHERE id = ? AND removing = 1");
  if (begun.bind(id).next()) return api::Done{};
  if (api::Status ok = begun.status(); !ok) return ok;
  const auto job = job_locked(id);
  if (!job) return job.error();
  if (!api::is_final(job->state))
    return api::Error{api::Fault::wrong_state, "the job is " + std::string(api::name_of(job->state)) +
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
  return ids_of(select);
}

api::Result<std::vector<std::string>> JobStore::all_ids() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT id FROM job");
  return ids_of(select);
}

api::Result<std::vector<std::string>> JobStore::expired(std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare(
      "SELECT id FROM job INDEXED BY job_expiry WHERE expires_ms IS NOT NULL AND expires_ms <= ? "
      "AND pinned = 0 ORDER BY expires_ms LIMIT ?");
  select.bind(clock_()).bind(limit);
  return ids_of(select);
}

api::Status JobStore::record_bytes(std::int64_t job_seq, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  Statement update = database_.prepare("UPDATE job SET bytes = ?, version = version + 1 WHERE seq = ?");
  return update.bind(bytes).bind(job_seq).run();
}

api::Result<std::int64_t> JobStore::total_bytes(std::optional<std::string_view> owner) {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare("SELECT coalesce(sum(bytes), 0) FROM job INDEXED BY job_bytes" +
                                       std::string(owner ? " WHERE owner = ?" : ""));
  if (owner) select.bind(*owner);
  const std::int64_t bytes = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return bytes;
}

}  // namespace server
