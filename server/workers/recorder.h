// Writes down how attempts ended, on threads of its own: what a worker left is hashed, which takes seconds
// for large jobs, and meanwhile the other workers must be watched, and their ends written down too.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
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
  /// Ends that are written down at once: what one worker has left may take long to read.
  std::size_t at_once = 4;
  std::chrono::milliseconds stop_patience{1'000};  ///< for what is being read when the server stops
};

class Recorder {
 public:
  /// `recorded` is called when a job may be in the queue again.
  Recorder(JobService& jobs, RecorderRules rules, std::function<void()> recorded);
  ~Recorder() { stop(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Kills the workers of these orphans and takes their jobs up again, as far as that is possible now; the
  /// rest is tried again later. Then starts the threads.
  void start(std::vector<Orphan> orphans);
  void add(EndedAttempt ended);
  /// Records what has been added, as far as that is possible soon, and ends the threads. The next server
  /// takes up what is left.
  void stop();

 private:
  using SteadyClock = std::chrono::steady_clock;

  void run();  ///< the one that catches up and collects garbage, too
  void run_beside();
  std::optional<EndedAttempt> next(SteadyClock::time_point until);
  void record_or_keep(EndedAttempt ended);
  void catch_up();
  void collect_garbage();
  bool take_up(const Orphan& orphan);  ///< false: must be tried again
  bool record(EndedAttempt& ended);    ///< false: must be tried again
  void complain(const std::string& trouble);

  JobService& jobs_;
  const RecorderRules rules_;
  const std::function<void()> recorded_;
  std::vector<Orphan> orphans_;  ///< of an earlier server, not taken up again yet
  std::atomic<bool> aborted_ = false;
  SteadyClock::time_point catch_up_at_{};
  SteadyClock::time_point collect_at_{};

  std::mutex mutex_;  ///< of what follows
  std::condition_variable added_;
  std::condition_variable ended_;
  std::deque<EndedAttempt> new_;
  std::vector<EndedAttempt> unrecorded_;  ///< their jobs are still `running` in the store
  std::string last_complaint_;            ///< said once, not every few seconds
  std::size_t at_work_ = 0;               ///< threads that have not ended
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace server
