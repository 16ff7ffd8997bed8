// Typed reads and writes of jobs. Every write is one transaction; every step between states goes through one
// private function that checks it, raises the version and leaves an event.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "server/store/database.h"
#include "server/store/job_rows.h"

namespace server {

using Clock = std::function<std::int64_t()>;  ///< milliseconds since 1970, UTC

std::int64_t system_clock_ms();

/// Where a job goes and why.
struct StepReason {
  std::string reason;   ///< stable word
  std::string message;  ///< for people
};

/// Safe for use by several threads. Faults: not_found for an unknown job, wrong_state for a step that the
/// job's state (or a newer lease) does not allow, disk_full, internal.
class JobStore {
 public:
  static api::Result<std::unique_ptr<JobStore>> open(const std::filesystem::path& file,
                                                     Clock clock = system_clock_ms);

  // Clients.
  api::Result<Job> insert(const NewJob& job);
  api::Result<Job> job(std::string_view id);
  /// Newest first, of `state` if given, older than `before_seq` if given.
  api::Result<std::vector<Job>> list(std::optional<api::JobState> state,
                                     std::optional<std::int64_t> before_seq, std::int64_t limit);
  api::Result<std::int64_t> count(api::JobState state);
  /// queued -> canceled, running -> cancel_requested; nothing to do for the two states it leads to.
  api::Result<Job> cancel(std::string_view id);
  /// Marks a finished job as being removed: from now on nobody sees it. The row goes with `erase`. Marking it
  /// again is no error, so that a removal that failed halfway can be asked for again.
  api::Status begin_removal(std::string_view id);
  api::Status erase(std::string_view id);
  api::Result<std::vector<std::string>> jobs_being_removed();
  /// Of all jobs that have a row, those being removed included.
  api::Result<std::vector<std::string>> all_ids();

  // Attempts.
  /// The oldest queued job becomes running under a new lease; none: nothing is waiting.
  api::Result<std::optional<Claim>> claim();
  api::Status record_worker(const Lease& lease, const ProcessIdentity& worker);
  /// Records progress and answers the job's state, so that the caller learns of a wish to cancel.
  api::Result<api::JobState> record_progress(const Lease& lease, const api::ProgressLine& line);
  api::Result<Job> leased_job(const Lease& lease);
  api::Status succeed(const Lease& lease, const Results& results, std::string_view report_json);
  api::Status fail(const Lease& lease, const StepReason& why, const AttemptEnd& end,
                   std::string_view report_json);
  /// running -> queued. `counted`: the attempt counts towards the limit of attempts without progress.
  api::Status requeue(const Lease& lease, const StepReason& why, const AttemptEnd& end, bool counted,
                      std::int64_t not_before_ms = 0);
  api::Status finish_cancel(const Lease& lease, const AttemptEnd& end);
  /// Of this job, that ended for this reason.
  api::Result<std::int64_t> count_attempts(std::int64_t job_seq, std::string_view reason);
  api::Result<std::vector<Orphan>> orphans();
  /// The wall clock may have jumped while the server was down: nobody waits longer than from now on.
  api::Status forget_waiting_times();

  // Results.
  api::Result<std::vector<InputFile>> inputs(std::int64_t job_seq);
  api::Result<std::vector<Attempt>> attempts(std::int64_t job_seq);
  api::Result<std::vector<Event>> events(std::int64_t job_seq);
  api::Result<std::vector<ArtefactFile>> artefacts(std::int64_t job_seq, std::string_view glob = "*");
  api::Result<ArtefactFile> artefact(std::int64_t job_seq, std::string_view path);
  api::Result<std::vector<api::FrameRecord>> frames(std::int64_t job_seq);

 private:
  struct Step {
    std::int64_t seq;
    api::JobState from;
    api::JobState to;
    StepReason why;
  };

  JobStore(Database database, Clock clock) : database_(std::move(database)), clock_(std::move(clock)) {}

  api::Status step(const Step& step);
  api::Status end_attempt(const Lease& lease, std::string_view outcome, const AttemptEnd& end);
  api::Status leave_running(const Lease& lease, const Step& step, const AttemptEnd& end,
                            std::string_view report_json);
  api::Status insert_results(std::int64_t job_seq, const Results& results);
  api::Result<Job> job_locked(std::string_view id);
  api::Result<Job> leased_job_locked(const Lease& lease);

  std::mutex mutex_;
  Database database_;
  Clock clock_;
};

}  // namespace server
