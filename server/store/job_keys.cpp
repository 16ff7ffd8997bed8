// The part of JobStore that knows a submission which comes twice.
#include "server/store/job_store.h"

namespace server {

api::Result<std::optional<JobStore::KeyedJob>> JobStore::job_of_key(std::string_view owner,
                                                                    std::string_view key,
                                                                    std::int64_t since_ms) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT id, request_sha256 FROM idempotency_key JOIN job ON seq = job_seq "
      "WHERE idempotency_key.owner = ? AND key = ? AND idempotency_key.created_ms > ? AND removing = 0");
  select.bind(owner).bind(key).bind(since_ms);
  const bool found = select.next();
  if (const api::Status ok = select.status(); !ok) return ok.error();
  if (!found) return std::optional<KeyedJob>();
  auto job = job_in(reading.database(), select.text(0));
  if (!job) return job.error();
  return std::optional(KeyedJob{std::move(*job), select.text(1)});
}

api::Status JobStore::forget_keys(std::int64_t before_ms) {
  const std::lock_guard lock(mutex_);
  Statement erase = database_.prepare("DELETE FROM idempotency_key WHERE created_ms <= ?");
  return erase.bind(before_ms).run();
}

}  // namespace server
