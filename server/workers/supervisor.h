// The one thread that starts workers and watches them.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "api/result.h"
#include "server/jobs/job_service.h"
#include "server/workers/attempt.h"
#include "server/workers/doorbell.h"
#include "server/workers/recorder.h"

namespace server {

/// Takes jobs from the queue, each into a worker process, as many at once as the budget allows by their
/// forecasts; one that needs more than all of it runs alone. Workers are started by this thread only, because
/// it lives as long as the server does: the kernel kills a worker with the thread that started it.
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
  /// Stops the workers, whose jobs stay queued, and the thread. Returns when all have ended.
  void stop();

 private:
  void run();
  WorkerUse use() const;
  bool start_next();  ///< false: nothing to start, no room, or none can be started now
  void notice_start(const std::string& why_not);
  void wait();
  void look_at_all();
  struct EndedAttempt {
    std::unique_ptr<RunningAttempt> attempt;
    AttemptOutcome outcome;
  };
  void explain_kills(std::vector<EndedAttempt>& ended);
  void complain(const std::string& trouble);

  JobService& jobs_;
  const Doorbell& bell_;
  const WorkerRules rules_;
  Recorder recorder_;
  MemoryKills memory_kills_;
  std::vector<std::unique_ptr<RunningAttempt>> running_;
  std::string last_complaint_;  ///< said once, not every second
  bool rung_ = false;
  std::chrono::milliseconds start_again_after_{0};  ///< 0: workers can be started
  std::chrono::steady_clock::time_point start_again_at_{};
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace server
