// The part of JobStore that knows what there may be at most.
#include "server/store/job_store.h"

namespace server {
namespace {

using api::Fault;

constexpr const char* kQueuedOfOwner =
    "SELECT count(*) FROM job INDEXED BY job_urgency WHERE state = 'queued' AND owner = ?";
constexpr const char* kQueued = "SELECT count(*) FROM job WHERE state = 'queued' AND removing = 0";
constexpr const char* kUnusedBytes =
    "SELECT coalesce(sum(bytes), 0) FROM job INDEXED BY job_unused WHERE finished_ms IS NOT NULL "
    "AND pinned = 0 AND removing = 0";

api::Result<std::int64_t> number_of(Statement& select) {
  const std::int64_t number = select.next() ? select.integer(0) : 0;
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return number;
}

api::Error over_quota(const std::string& what, std::int64_t kept, std::int64_t most) {
  return {Fault::over_quota, what + " take " + std::to_string(kept) + " of " + std::to_string(most) +
                                 " bytes; there is room again when some are removed"};
}

}  // namespace

api::Status JobStore::admit(std::string_view owner, std::int64_t bytes, const Ceilings& most) {
  Reading reading(*readers_);
  return admit_in(reading.database(), owner, bytes, most);
}

api::Status JobStore::admit_in(Database& database, std::string_view owner, std::int64_t bytes,
                               const Ceilings& most) {
  if (api::Status room = admit_to_queue(database, owner, most); !room) return room;
  if (most.bytes != INT64_MAX) {
    const auto kept = total_bytes_in(database, {});
    if (!kept) return kept.error();
    const auto spare =
        most.evict && *kept + bytes > most.bytes ? unused_bytes_in(database) : api::Result<std::int64_t>(0);
    if (!spare) return spare.error();
    if (*kept - *spare + bytes > most.bytes)
      return over_quota("all jobs and blobs together", *kept, most.bytes);
  }
  if (most.bytes_of_one_owner == INT64_MAX) return api::Done{};
  const auto kept = total_bytes_in(database, owner);
  if (!kept) return kept.error();
  if (*kept + bytes <= most.bytes_of_one_owner) return api::Done{};
  return over_quota("your jobs and blobs", *kept, most.bytes_of_one_owner);
}

api::Status JobStore::admit_to_queue(Database& database, std::string_view owner, const Ceilings& most) {
  if (most.queued != INT64_MAX) {
    Statement select = database.prepare(kQueued);
    const auto waiting = number_of(select);
    if (!waiting) return waiting.error();
    if (*waiting >= most.queued)
      return api::Error{Fault::out_of_resources,
                        "the queue is full: " + std::to_string(*waiting) + " jobs are waiting"};
  }
  if (most.queued_of_one_owner == INT64_MAX) return api::Done{};
  Statement select = database.prepare(kQueuedOfOwner);
  select.bind(owner);
  const auto of_owner = number_of(select);
  if (!of_owner) return of_owner.error();
  if (*of_owner >= most.queued_of_one_owner)
    return api::Error{Fault::too_many, "you have " + std::to_string(*of_owner) +
                                           " jobs in the queue already, as many as one may have"};
  return api::Done{};
}

api::Result<std::int64_t> JobStore::unused_bytes_in(Database& database) {
  Statement select = database.prepare(kUnusedBytes);
  return number_of(select);
}

api::Result<std::int64_t> JobStore::total_bytes(std::optional<std::string_view> owner) {
  Reading reading(*readers_);
  return total_bytes_in(reading.database(), owner);
}

api::Result<std::int64_t> JobStore::total_bytes_in(Database& database,
                                                   std::optional<std::string_view> owner) {
  const auto blobs = blob_bytes_in(database, owner);
  if (!blobs) return blobs.error();
  Statement select = database.prepare("SELECT coalesce(sum(bytes), 0) FROM job INDEXED BY job_bytes" +
                                      std::string(owner ? " WHERE owner = ?" : ""));
  if (owner) select.bind(*owner);
  const auto bytes = number_of(select);
  if (!bytes) return bytes;
  return *bytes + *blobs;
}

}  // namespace server
