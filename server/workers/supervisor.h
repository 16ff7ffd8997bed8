// The one thread that starts workers and watches them.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "api/result.h"
#include "server/jobs/job_service.h"
#include "server/workers/attempt.h"
#include "server/workers/doorbell.h"

namespace server {

/// Takes the jobs of the queue one after the other, each in a worker process. Workers are started by this
/// thread only, because it lives as long as the server does: the kernel kills a worker with the thread that
/// started it.
class Supervisor {
 public:
  /// `bell` is rung when there is something to do: a new job, or a wish to cancel.
  Supervisor(JobService& jobs, const Doorbell& bell, WorkerRules rules);
  ~Supervisor() { stop(); }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Makes sure that the workers of an earlier server are dead, queues their jobs again, then starts. What
  /// cannot be done yet (full disk) is tried again while the other jobs go on.
  api::Status start();
  /// Stops the worker, whose job stays queued, and the thread. Returns when both have ended.
  void stop();

 private:
  using SteadyClock = std::chrono::steady_clock;

  struct EndedAttempt {
    std::string id;
    Lease lease;
    AttemptOutcome outcome;
  };

  void run();
  void run_one(const Claim& claim);
  void rest();
  void catch_up();
  bool take_up(const Orphan& orphan);        ///< false: must be tried again
  bool record(const EndedAttempt& attempt);  ///< false: must be tried again
  void complain(const std::string& trouble);

  JobService& jobs_;
  const Doorbell& bell_;
  WorkerRules rules_;
  std::vector<Orphan> orphans_;           ///< of an earlier server, not taken up again yet
  std::vector<EndedAttempt> unrecorded_;  ///< their jobs are still `running` in the store
  SteadyClock::time_point catch_up_at_{};
  std::string last_complaint_;  ///< said once, not every second
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace server
