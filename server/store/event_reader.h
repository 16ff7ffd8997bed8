// What happened to jobs, read beside the connection that writes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "server/store/database.h"

namespace server {

/// One step of a job between states. The ids rise, are never used twice, and outlive restarts.
struct JobEvent {
  std::int64_t id = 0;
  std::int64_t at_ms = 0;
  std::int64_t job_seq = 0;
  std::string job_id;
  std::optional<std::string> from;  ///< none: the job was submitted
  std::string to;                   ///< kRemoved: the job is gone
  std::string reason;
  std::string message;
};

inline constexpr std::string_view kRemoved = "removed";

/// How far a job is that a worker is at.
struct JobProgress {
  std::int64_t job_seq = 0;
  std::string job_id;
  std::int64_t version = 0;
  std::int64_t attempt = 0;
  std::optional<std::string> stage;
  double stage_fraction = 0;
  double fraction = 0;
  std::optional<double> seconds_left;
  std::string owner = {};
};

struct EventPage {
  std::vector<JobEvent> events;
  std::int64_t through = 0;  ///< all events up to this id have been looked at
};

/// Safe for use by several threads. The events of a removed job go with it, but for the last one:
/// that it was removed is told of until a million later events.
class EventReader {
 public:
  /// The database must have been opened, and brought up to date, by a JobStore.
  static api::Result<std::unique_ptr<EventReader>> open(const std::filesystem::path& file);

  /// Has anything been committed since the last call, or since `open`? Costs microseconds.
  api::Result<bool> changed();
  /// 0: none yet.
  api::Result<std::int64_t> newest();
  /// Oldest first, of all jobs or of one.
  api::Result<std::vector<JobEvent>> after(std::int64_t id, std::optional<std::int64_t> job_seq,
                                           std::int64_t limit);
  /// Oldest first, of the jobs of one owner. `through` spares the next call what is not theirs.
  api::Result<EventPage> of_owner_after(std::string_view owner, std::int64_t id, std::int64_t limit);
  /// Of all jobs that are being worked at.
  api::Result<std::vector<JobProgress>> progress();

 private:
  api::Result<std::int64_t> newest_locked();
  api::Status add_removals(std::vector<JobEvent>& events, std::string_view which, std::int64_t id,
                           std::optional<std::int64_t> job_seq, std::optional<std::string_view> owner,
                           std::int64_t limit);

  explicit EventReader(Database database) : database_(std::move(database)) {}

  std::mutex mutex_;
  Database database_;
  std::int64_t seen_version_ = -1;
};

}  // namespace server
