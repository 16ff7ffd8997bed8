// What can be done with jobs: by clients, and by the supervisor that runs them. Knows neither HTTP nor SQL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/job_request.h"
#include "api/result.h"
#include "server/artefacts/data_folder.h"
#include "server/jobs/attempt_outcome.h"
#include "server/store/job_store.h"

namespace server {

/// A job's files as they came in, in DataFolder::upload(id)/input/.
struct Upload {
  std::string id;  ///< new_job_id(); becomes the job's
  std::vector<InputFile> inputs;
};

/// Looks at the files of a job folder without running it, and leaves check.json there. Errors:
/// invalid_request with violations where the job is wrong.
using CheckJob = std::function<api::Status(const std::filesystem::path& job_folder)>;

struct JobRules {
  std::uint32_t attempts_without_progress_max = 3;
  std::int64_t queued_max = 10'000;
  /// How often a job may run when the server is killed: more than by chance, so it may be the job's doing.
  std::uint32_t orphaned_attempts_max = 10;
  std::uint32_t disk_full_attempts_max = 10;
  std::int64_t disk_full_wait_ms = 30'000;  ///< doubled with every attempt, up to disk_full_wait_ms_max
  std::int64_t disk_full_wait_ms_max = 3'600'000;
  CheckJob check;
  std::function<void()> work_arrived = [] {};      ///< something was queued
  std::function<void()> cancel_requested = [] {};  ///< a running job is to stop
};

/// One page of the list, newest first.
struct JobPage {
  std::vector<Job> jobs;
  std::optional<std::int64_t> next;  ///< pass as `before` for the next page; none: this was the last
};

/// Safe for use by several threads.
class JobService {
 public:
  JobService(JobStore& store, const DataFolder& folder, JobRules rules, Clock clock = system_clock_ms);

  /// Checks the upload in full, then makes it a queued job that survives whatever happens from now on. On any
  /// error nothing of it is left on disk. Errors: invalid_request (violations), out_of_resources (queue
  /// full), disk_full, internal.
  api::Result<Job> submit(const Upload& upload);
  /// Checks the upload as submit does, and answers what the check found: warnings and the forecast. Nothing
  /// of it is left on disk. Errors: those of submit, but for the queue.
  api::Result<api::JobReport> validate(const Upload& upload);
  /// Forgets an upload that did not become a job.
  void discard(const Upload& upload) const;

  api::Result<Job> job(std::string_view id) { return store_.job(id); }
  api::Result<JobPage> list(std::optional<api::JobState> state, std::optional<std::int64_t> before,
                            std::int64_t limit);
  api::Result<Job> cancel(std::string_view id);
  /// A finished job and all its files: files first, row last. Errors: not_found, wrong_state, internal.
  api::Status remove(std::string_view id);

  // Results, for reading.
  api::Result<ArtefactFile> artefact(const Job& job, std::string_view path);
  /// Those whose path fits `glob`, in which * stands for anything.
  api::Result<std::vector<ArtefactFile>> artefacts(const Job& job, std::string_view glob = "*") {
    return store_.artefacts(job.seq, glob);
  }
  /// One record per frame of a job that has succeeded. Errors: not_found where it was removed meanwhile.
  api::Result<std::vector<api::FrameRecord>> frames(const Job& job);
  std::filesystem::path folder_of(const Job& job) const { return folder_.job(job.id); }

  // For the supervisor.
  api::Result<std::optional<Claim>> claim() { return store_.claim(); }
  api::Status record_worker(const Lease& lease, const ProcessIdentity& worker) {
    return store_.record_worker(lease, worker);
  }
  api::Result<api::JobState> record_progress(const Lease& lease, const api::ProgressLine& line) {
    return store_.record_progress(lease, line);
  }
  /// Is this attempt still wanted?
  bool still_wanted(const Lease& lease);
  /// The worker of this attempt is dead: what becomes of the job follows from how it ended.
  api::Status end_attempt(const Lease& lease, const AttemptOutcome& outcome);

  // At start-up, in this order.
  api::Result<std::vector<Orphan>> orphans() { return store_.orphans(); }
  /// The worker of this orphan, if it had one, is dead: running -> queued, cancel_requested -> canceled;
  /// failed where it ran too often when a server was killed.
  api::Status take_up_again(const Orphan& orphan);
  /// Ends removals that were under way and deletes files that no job owns, as far as that is possible now.
  api::Status clean_up();

 private:
  api::Result<NewJob> read_request(const Upload& upload) const;
  api::Result<NewJob> check(const Upload& upload) const;
  api::Result<Job> keep(const Upload& upload, const NewJob& row);
  void forget_checkpoint(const Job& job) const;
  api::Status settle(const Job& job, const Lease& lease, const AttemptOutcome& outcome);
  api::Status succeed(const Job& job, const Lease& lease, const AttemptOutcome& outcome);
  api::Status wait_for_room_or_fail(const Job& job, const Lease& lease, const AttemptOutcome& outcome);
  api::Status try_again_or_fail(const Job& job, const Lease& lease, const AttemptOutcome& outcome);
  api::Status remove_files_and_row(const std::string& id);

  JobStore& store_;
  const DataFolder& folder_;
  JobRules rules_;
  Clock clock_;
  mutable std::mutex parsing_;
  std::mutex removing_;  ///< two removals of one job would meet half of its files
};

}  // namespace server
