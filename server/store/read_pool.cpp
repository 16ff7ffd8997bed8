#include "server/store/read_pool.h"

#include <algorithm>
#include <utility>

namespace server {

api::Result<std::unique_ptr<ReadPool>> ReadPool::open(const std::filesystem::path& file, std::size_t count) {
  std::unique_ptr<ReadPool> pool(new ReadPool());
  for (std::size_t i = 0; i < count; ++i) {
    auto database = Database::open_to_read(file);
    if (!database) return database.error();
    pool->all_.push_back(std::move(*database));
  }
  for (Database& database : pool->all_) pool->free_.push_back(&database);
  return pool;
}

bool ReadPool::damaged() const {
  return std::any_of(all_.begin(), all_.end(), [](const Database& each) { return each.damaged(); });
}

Database& ReadPool::take() {
  std::unique_lock lock(mutex_);
  given_back_.wait(lock, [this] { return !free_.empty(); });
  Database* database = free_.back();
  free_.pop_back();
  return *database;
}

void ReadPool::give_back(Database& database) {
  {
    const std::lock_guard lock(mutex_);
    free_.push_back(&database);
  }
  given_back_.notify_one();
}

Reading::Reading(ReadPool& pool) : pool_(pool), database_(pool.take()) {
  // Where that fails every statement sees a moment of its own, and says what is wrong.
  (void)database_.prepare("BEGIN").run();
}

Reading::~Reading() {
  (void)database_.prepare("COMMIT").run();
  if (database_.in_transaction()) (void)database_.execute("ROLLBACK");
  pool_.give_back(database_);
}

}  // namespace server
