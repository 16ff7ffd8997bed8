#include "server/store/job_store.h"

namespace server {

api::Status JobStore::can_write() {
  if (database_.damaged() || readers_->damaged())
    return api::Error{api::Fault::internal, "the database is damaged; see check, and restore a backup"};
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) {
    // Somebody is writing, so one can; unless that does not come to an end.
    const auto waited = std::chrono::duration_cast<std::chrono::seconds>(mutex_.held_for());
    if (waited < kWriteMax) return api::Done{};
    return api::Error{api::Fault::internal,
                      "a write has been waiting for the disk for " + std::to_string(waited.count()) + " s"};
  }
  // Taking the write lock is refused where the file or its folder cannot be written; rolled back at once.
  database_.set_patience(std::chrono::milliseconds(0));
  Transaction transaction(database_);
  api::Status begun = transaction.begin();
  database_.set_patience(kLockPatience);
  return begun;
}

}  // namespace server
