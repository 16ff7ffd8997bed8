// Connections that only read, beside the one that writes. A commit takes as long as the disk does, which may
// be minutes where it stalls, and the connection that commits is held for all of it; who reads here never
// waits for it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "api/result.h"
#include "server/store/database.h"

namespace server {

/// Safe for use by several threads.
class ReadPool {
 public:
  /// The database must have been brought up to date by the connection that writes.
  static api::Result<std::unique_ptr<ReadPool>> open(const std::filesystem::path& file, std::size_t count);

  /// Has SQLite found a page that is none, on any of them?
  bool damaged() const;

 private:
  friend class Reading;

  ReadPool() = default;
  Database& take();
  void give_back(Database& database);

  std::vector<Database> all_;
  std::mutex mutex_;  ///< of what follows
  std::condition_variable given_back_;
  std::vector<Database*> free_;  ///< the one that was used last is taken first: what it read is still at hand
};

/// One of the connections, for as long as this lives, and the database as it is at one moment: what several
/// statements read fits together. It sees all that was committed before it began. To be short: what it may
/// still want to see, the write-ahead log must keep. A thread has one at a time, or those who wait for a
/// second could wait for each other.
class Reading {
 public:
  explicit Reading(ReadPool& pool);
  ~Reading();
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

  Database& database() { return database_; }
  Statement prepare(std::string_view sql) { return database_.prepare(sql); }

 private:
  ReadPool& pool_;
  Database& database_;
};

}  // namespace server
