// Writes down how attempts ended, on a thread of its own: what a worker left is hashed, which takes seconds
// for large jobs, and meanwhile the other workers must be watched.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "api/result.h"
#include "server/jobs/job_service.h"

namespace server {

struct EndedAttempt {
  std::string id;
  Lease lease;
  AttemptOutcome outcome;
};

struct RecorderRules {
  std::chrono::milliseconds retry_every{5'000};     ///< what the store could not take
  std::chrono::milliseconds collect_every{60'000};  ///< jobs whose time is over
};

class Recorder {
 public:
  /// `recorded` is called when a job may be in the queue again.
  Recorder(JobService& jobs, RecorderRules rules, std::function<void()> recorded);
  ~Recorder() { stop(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Kills the workers of these orphans and takes their jobs up again, as far as that is possible now; the
  /// rest is tried again later. Then starts the thread.
  void start(std::vector<Orphan> orphans);
  void add(EndedAttempt ended);
  /// Records what has been added, as far as that is possible now, and ends the thread.
  void stop();

 private:
  using SteadyClock = std::chrono::steady_clock;

  void run();
  void catch_up();
  void collect_garbage();
  bool take_up(const Orphan& orphan);      ///< false: must be tried again
  bool record(const EndedAttempt& ended);  ///< false: must be tried again
  void complain(const std::string& trouble);

  JobService& jobs_;
  const RecorderRules rules_;
  const std::function<void()> recorded_;
  std::vector<Orphan> orphans_;           ///< of an earlier server, not taken up again yet
  std::vector<EndedAttempt> unrecorded_;  ///< their jobs are still `running` in the store
  std::string last_complaint_;            ///< said once, not every few seconds
  SteadyClock::time_point catch_up_at_{};
  SteadyClock::time_point collect_at_{};

  std::mutex mutex_;  ///< of what follows
  std::condition_variable added_;
  std::vector<EndedAttempt> new_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace server
