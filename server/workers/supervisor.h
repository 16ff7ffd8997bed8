// The one thread that starts workers and watches them.
#pragma once

#include <atomic>
#include <thread>

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

  /// Makes sure that the workers of an earlier server are dead, queues their jobs again, then starts.
  api::Status start();
  /// Stops the worker, whose job stays queued, and the thread. Returns when both have ended.
  void stop();

 private:
  api::Status take_up_orphans();
  void run();
  void run_one(const Claim& claim);
  void rest();

  JobService& jobs_;
  const Doorbell& bell_;
  WorkerRules rules_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace server
