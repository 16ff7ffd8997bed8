#include "server/store/job_store.h"

namespace server {

api::Status JobStore::can_write() {
  const std::lock_guard lock(mutex_);
  if (database_.damaged())
    return api::Error{api::Fault::internal, "the database is damaged; see check, and restore a backup"};
  // Taking the write lock is refused where the file or its folder cannot be written; rolled back at once.
  Transaction transaction(database_);
  return transaction.begin();
}

}  // namespace server
