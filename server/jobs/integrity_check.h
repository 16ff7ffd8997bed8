// Are the database and the files of all jobs still what they were? Looked at a share at a time, in the
// background.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "api/result.h"
#include "server/artefacts/data_folder.h"
#include "server/store/job_store.h"
#include "server/store/maintenance.h"

namespace server {

struct IntegrityRules {
  std::chrono::milliseconds every = std::chrono::hours(24);  ///< from one check to the next; 0: never
  std::chrono::milliseconds time_max =
      std::chrono::hours(1);  ///< of a check, and as long beside it; the next one goes on from there
};

struct IntegrityReport {
  std::int64_t ended_ms = 0;          ///< when the last check came to its end; 0: none has yet
  std::int64_t round_ms = 0;          ///< when every file had been looked at last; 0: not yet
  std::int64_t damaged_files = 0;     ///< known now
  std::vector<std::string> database;  ///< what the last check found wrong with it
  std::int64_t files = 0;             ///< looked at since the server started
  std::int64_t bytes = 0;
};

/// Safe for use by several threads. Its own thread has the lowest priority there is, for processor and disk.
class IntegrityCheck {
 public:
  /// `database` is read by a connection of its own, so that nobody waits for it.
  IntegrityCheck(JobStore& store, const DataFolder& folder, IntegrityRules rules,
                 Clock clock = system_clock_ms);
  ~IntegrityCheck() { stop(); }
  IntegrityCheck(const IntegrityCheck&) = delete;
  IntegrityCheck& operator=(const IntegrityCheck&) = delete;

  /// Looked at after the files of every check, by its thread, for up to so long; ends soon after `stopping`
  /// turns true.
  using Beside =
      std::function<api::Status(std::chrono::milliseconds time_max, const std::atomic<bool>& stopping)>;
  /// Before start().
  void also(Beside beside) { beside_ = std::move(beside); }

  /// From now on a check every `rules.every`, counted from the last one, also where that was before a
  /// restart.
  void start();
  /// Soon, also in the middle of a large file.
  void stop();
  /// One check, now, by the caller. Errors: internal, disk_full, stopped.
  api::Status check();
  IntegrityReport report() const;

 private:
  void run();
  std::chrono::milliseconds until_next() const;
  api::Status check_database();
  api::Status check_files();
  api::Status check_share(Database& database, IntegrityState& state);
  api::Status look_at(const KeptFile& file);

  JobStore& store_;
  const DataFolder& folder_;
  const IntegrityRules rules_;
  const Clock clock_;
  Beside beside_;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable stopped_;
  IntegrityReport report_;
  std::thread thread_;
};

}  // namespace server
