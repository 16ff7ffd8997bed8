// What the operator allows jobs to take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "api/result.h"

namespace server {

/// Looks at the files of a job folder without running it, and leaves check.json there. Errors:
/// invalid_request with violations where the job is wrong.
using CheckJob = std::function<api::Status(const std::filesystem::path& job_folder)>;

/// What all workers together may take, as their forecasts say. A job that needs more runs alone.
struct WorkerBudget {
  std::int64_t cores = 1;
  std::int64_t memory_bytes = INT64_MAX;
};

/// Of files that are sent one by one, before the jobs that name them.
struct BlobRules {
  std::int64_t total_bytes = std::int64_t{8} << 30;  ///< of all owners together
  std::int64_t unused_ms = 24 * 3600 * 1000;         ///< after so long without use they go
};

/// What a worker may leave in its job's folder: far more than an honest one does, and an end to what another
/// could. No more than the quotas either.
struct WrittenRules {
  std::int64_t files = 200'000;  ///< and folders
  int depth = 16;                ///< of folders in folders
  std::int64_t bytes = std::int64_t{8} << 30;
  std::int64_t bytes_per_frame = std::int64_t{256} << 20;  ///< beside them, for pictures
  std::int64_t bytes_per_value = 160;  ///< beside those, for each patch in each frame; honest: 40 at most
};

struct JobRules {
  std::uint32_t attempts_without_progress_max = 3;
  std::int64_t queued_max = 10'000;
  std::int64_t queued_of_one_owner_max = 10'000;
  std::int64_t bytes_max = INT64_MAX;  ///< of all jobs and blobs together, with results, views and videos
  std::int64_t bytes_of_one_owner_max = INT64_MAX;  ///< of those of one token
  /// Rather than be over bytes_max, remove finished jobs that nobody has used for longest.
  bool evict = false;
  std::optional<std::int64_t> ttl_ms;  ///< of jobs that do not say how long they are to be kept
  BlobRules blobs;
  std::int64_t key_ms = 24 * 3600 * 1000;  ///< that an Idempotency-Key is kept
  std::size_t waiters_max = 8;             ///< requests that wait for a job to end; each holds a thread
  /// How often a job may run when the server is killed: more than by chance, so it may be the job's doing.
  std::uint32_t orphaned_attempts_max = 10;
  std::uint32_t disk_full_attempts_max = 10;
  std::int64_t disk_full_wait_ms = 30'000;  ///< doubled with every attempt, up to disk_full_wait_ms_max
  std::int64_t disk_full_wait_ms_max = 3'600'000;
  WrittenRules written;
  WorkerBudget budget;
  CheckJob check;
  CheckJob preview = {};  ///< the same, but for the forecast, and leaves preview/preview.npz as well
  std::function<void()> work_arrived = [] {};      ///< something was queued
  std::function<void()> cancel_requested = [] {};  ///< a running job is to stop
};

}  // namespace server
