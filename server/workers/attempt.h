// One attempt: a worker process from start to death.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "server/jobs/attempt_outcome.h"
#include "server/jobs/job_service.h"
#include "server/workers/child_process.h"
#include "server/workers/doorbell.h"

namespace server {

struct WorkerRules {
  std::filesystem::path program;                   ///< the worker executable
  std::vector<std::string> render_options;         ///< handed to `keylume render JOB_FOLDER` as they are
  std::chrono::milliseconds silence_max{120'000};  ///< without a progress line: stuck, killed
  std::chrono::milliseconds stop_grace{5'000};     ///< from SIGTERM to SIGKILL
  std::chrono::milliseconds look_every{100};       ///< at the progress file
  std::chrono::milliseconds record_every{500};     ///< at most two writes to the store per second
  std::chrono::milliseconds retry_every{5'000};    ///< what the store could not take
};

/// Runs the worker on the claimed job and returns when it is dead, whatever it did. `bell` rings when there
/// is something to look at: a wish to cancel, or `stopping`.
/// Call on a thread that lives as long as the server.
AttemptOutcome run_attempt(JobService& jobs, const Claim& claim, const WorkerRules& rules,
                           const Doorbell& bell, const std::atomic<bool>& stopping);

/// The meaning of an exit code or signal that was not our doing.
AttemptOutcome outcome_of(const ProcessEnd& end);

}  // namespace server
