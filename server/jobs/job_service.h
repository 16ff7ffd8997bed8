// What can be done with jobs: by clients, and by the supervisor that runs them. Knows neither HTTP nor SQL.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/job_request.h"
#include "api/result.h"
#include "server/artefacts/blobs.h"
#include "server/artefacts/data_folder.h"
#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/jobs/attempt_outcome.h"
#include "server/jobs/clock_doubt.h"
#include "server/jobs/job_rules.h"
#include "server/jobs/submission_keys.h"
#include "server/store/job_store.h"

namespace server {

/// A job's files as they came in, in DataFolder::upload(id)/input/.
struct Upload {
  std::string id;  ///< new_job_id(); becomes the job's
  std::vector<InputFile> inputs;
  std::string options = {};  ///< JSON, api::parse_job_options; empty: none were sent
  std::string owner = {};    ///< name of the token that it came with; empty: nobody's
};

/// What became of a submission.
struct Submitted {
  Job job;
  bool replayed = false;  ///< the job was there already, made by an earlier request with the same key
};

/// Who asks. Other owners' jobs are to them as if they did not exist, unless they see all.
struct Viewer {
  std::string_view owner;
  bool sees_all = false;
};

/// One page of the list, newest first.
struct JobPage {
  std::vector<Job> jobs;
  std::optional<std::int64_t> next;  ///< pass as `before_seq` for the next page; none: this was the last
};

/// The place of every queued job, by seq; 1 is the next.
using QueuePositions = std::map<std::int64_t, std::int64_t>;

/// What the workers of now take, as forecast.
struct WorkerUse {
  std::int64_t workers = 0;
  std::int64_t cores = 0;
  std::int64_t memory_bytes = 0;
};

struct QueueReport {
  QueueSwitch queue;
  std::map<api::JobState, std::int64_t> jobs;  ///< of every state, as far as the viewer sees them
  WorkerUse use;
  WorkerBudget budget;
  std::string held = {};  ///< why nothing is started although it is not paused; empty: nothing is in the way
};

/// What a removal deletes, or would.
struct Removal {
  std::int64_t bytes = 0;
  std::int64_t files = 0;
};

/// What the collection of garbage has done since the server started.
struct GarbageReport {
  std::int64_t last_ms = 0;  ///< when it last did all there was to do; 0: not yet
  std::int64_t jobs = 0;     ///< removed because their time was over
  std::int64_t bytes = 0;
  std::int64_t evicted_jobs = 0;  ///< removed to make room for others
  std::int64_t evicted_bytes = 0;
};

/// What a worker is to do next.
enum class Wanted { go_on, pause, cancel, deadline_passed, run_time_exceeded };

/// Errors: invalid_request, naming `file`, where the deadline is no later than `now_ms`.
api::Status refuse_past_deadline(const api::JobOptions& options, std::int64_t now_ms, std::string_view file);

/// Safe for use by several threads.
class JobService {
 public:
  /// `steady`: runs like the wall clock `clock`, but cannot be set.
  JobService(JobStore& store, const DataFolder& folder, JobRules rules, Clock clock = system_clock_ms,
             Clock steady = boot_clock_ms);

  // Submission: job_service.cpp, submission_keys.cpp.
  /// Checks the upload in full, then makes it a queued job that survives whatever happens from now on. On any
  /// error nothing of it is left on disk. Errors: invalid_request (violations), out_of_resources (queue
  /// full), too_many, over_quota, disk_full, internal.
  api::Result<Job> submit(const Upload& upload);
  /// The same under a key that the caller holds; a job that was made with it and the same upload is answered
  /// instead of a second one. Errors: also invalid_request where the key was used for another upload.
  api::Result<Submitted> submit(const Upload& upload, const HeldKey& key);
  /// None: an earlier request with this key is still being answered.
  std::optional<HeldKey> hold_key(std::string_view owner, std::string_view key) {
    return keys_.hold(owner, key);
  }
  /// Would a submission of so many bytes be refused whatever it holds? Errors: those of submit.
  api::Status admit(std::string_view owner, std::int64_t bytes);
  /// Do the quotas leave so many bytes to this owner? With what could be evicted. Errors: over_quota.
  api::Status within_quota(std::string_view owner, std::int64_t bytes);
  /// Checks the upload as submit does, and answers what the check found: warnings and the forecast. Nothing
  /// of it is left on disk. Errors: those of submit, but for the queue and quotas.
  api::Result<api::JobReport> validate(const Upload& upload);
  /// Checks the upload as validate does; answers preview/preview.npz, open, whose name is gone. Errors: as
  /// validate.
  api::Result<FileHandle> preview(const Upload& upload);
  /// Forgets an upload that did not become a job.
  void discard(const Upload& upload) const;

  // Files that are sent before the jobs that name them, each its owner's: owned_blobs.cpp.
  /// For reading; it counts as used now. Errors: not_found, also where it is another owner's; internal.
  api::Result<FileHandle> open_blob(std::string_view owner, std::string_view sha256);
  /// Moves the file `from`, written but not yet durable, to its place, if it is what `sha256` says. It is
  /// gone from `from` only on success. Errors: invalid_request (other bytes), over_quota, disk_full,
  /// internal.
  api::Status keep_blob(std::string_view owner, const std::filesystem::path& from, std::string_view sha256);

  /// Its bytes are no longer what its name says: nobody has it any more.
  api::Status drop_blob(std::string_view sha256);

  // What clients see and wish: job_actions.cpp.
  api::Result<Job> job(std::string_view id) { return store_.job(id); }
  /// Errors: not_found, word for word as for a job that does not exist, where `viewer` may not see it.
  api::Status must_see(std::string_view id, const Viewer& viewer);
  api::Result<JobPage> list(const JobFilter& filter, std::int64_t limit);
  api::Result<Job> cancel(std::string_view id);
  /// A running job stops once its worker has saved what is whole, from which it goes on later: the lines that
  /// were being traced are lost, of an animation of more than 128 frames what came since the last checkpoint.
  api::Result<Job> pause(std::string_view id);
  api::Result<Job> resume(std::string_view id);
  /// A failed or canceled job is queued again; it goes on from its last checkpoint, unless `from_start`.
  api::Result<Job> retry(std::string_view id, bool from_start = false);
  api::Result<Job> change(std::string_view id, const api::JobOptions& options,
                          std::optional<std::int64_t> version);
  /// A finished job and all its files: files first, row last. Errors: not_found, wrong_state, internal.
  api::Status remove(std::string_view id);
  /// `end` is called with the id of a job that is being removed, before its files go; once it returns nobody
  /// makes new ones. Before jobs are removed.
  void before_removal(std::function<void(const std::string& id)> end) { end_making_ = std::move(end); }
  /// Somebody asks for what it made: it is evicted later.
  void use(const Job& job);
  /// Something was added to its folder or removed from it. Quotas may be a little behind: errors are logged.
  void record_bytes(const Job& job);
  /// What `remove` would delete. Errors: those of `remove`.
  api::Result<Removal> what_remove_deletes(std::string_view id);
  /// Returns when the job is final, after `patience`, or soon after stop_waiting(). Errors: not_found,
  /// out_of_resources where too many wait already.
  api::Result<Job> wait_until_final(std::string_view id, std::chrono::milliseconds patience);
  /// Ends all waiting, now and later: the server stops.
  void stop_waiting();

  // The queue: queue_state.cpp.
  /// Jobs are counted as far as `viewer` sees them.
  api::Result<QueueReport> queue(const Viewer& viewer = {{}, true});
  /// Jobs that run go on, none is started.
  api::Result<QueueReport> pause_queue(std::string_view reason);
  api::Result<QueueReport> resume_queue();
  /// Of now or a moment ago.
  std::shared_ptr<const QueuePositions> queue_positions();
  /// Removes jobs whose time is over and keys that are too old. What cannot be removed is tried again.
  api::Status collect_garbage();
  GarbageReport garbage() const;

  // Results, for reading: job_actions.cpp.
  api::Result<ArtefactFile> artefact(const Job& job, std::string_view path);
  /// Errors: damaged_file where one of those files is known to be damaged.
  api::Status must_be_whole(const Job& job, std::string_view glob = "*") {
    return store_.must_be_whole(job.seq, glob);
  }
  /// Those whose path fits `glob`, in which * stands for anything.
  api::Result<std::vector<ArtefactFile>> artefacts(const Job& job, std::string_view glob = "*") {
    return store_.artefacts(job.seq, glob);
  }
  api::Result<std::vector<InputFile>> inputs(const Job& job) { return store_.inputs(job.seq); }
  /// Are the inputs what came in? All by their sizes, by their hashes those that 256 MB have room for, the
  /// smallest first, which takes less than a second: the rest is left to the integrity check. Errors:
  /// invalid_request naming a file that has changed; internal: input_check.cpp.
  api::Status must_have_whole_inputs(const Job& job);
  /// One record per frame of a job that has succeeded. Errors: not_found where it was removed meanwhile.
  api::Result<std::vector<api::FrameRecord>> frames(const Job& job);
  std::filesystem::path folder_of(const Job& job) const { return folder_.job(job.id); }

  // For the supervisor: end_attempt.cpp.
  /// Of the jobs whose deadline has not passed; none while the disk is full. Once there is room again, jobs
  /// that waited for it need wait no longer.
  api::Result<std::optional<Claim>> claim(const Room& room = {});
  /// Waiting jobs whose deadline has passed become failed; also to be asked for where there is no room to
  /// claim.
  api::Status fail_overdue();
  api::Status record_worker(const Lease& lease, const ProcessIdentity& worker) {
    return store_.record_worker(lease, worker);
  }
  api::Result<api::JobState> record_progress(const Lease& lease, const api::ProgressLine& line) {
    return store_.record_progress(lease, line);
  }
  /// Is this attempt, which has been running for so long, still wanted?
  Wanted wanted(const Lease& lease, std::int64_t ran_ms = 0);
  void set_use(const WorkerUse& use);
  /// Why no worker can be started, for whoever looks at the queue; empty: they can.
  void set_trouble(std::string why);
  /// What its worker has written beyond what it may; none: it keeps to that.
  std::optional<std::string> excess_of(const Job& job) const;
  /// The worker of this attempt is dead: what becomes of the job follows from how it ended. Takes as long as
  /// reading what it has left; Fault::stopped soon after `stopping` turns true, and the job is still running.
  api::Status end_attempt(const Lease& lease, const AttemptOutcome& outcome,
                          const std::atomic<bool>& stopping = kNeverStops);

  // At start-up, in this order.
  api::Result<std::vector<Orphan>> orphans() { return store_.orphans(); }
  /// The worker of this orphan, if it had one, is dead: running -> queued, pause_requested -> paused,
  /// cancel_requested -> canceled; failed where it ran too often when a server was killed.
  api::Status take_up_again(const Orphan& orphan);
  /// Ends removals that were under way and deletes files that no job owns, as far as that is possible now.
  api::Status clean_up();

 private:
  api::Result<NewJob> read_request(const Upload& upload) const;
  api::Result<NewJob> check(const Upload& upload);
  Ceilings ceilings() const;
  api::Status make_room(std::int64_t bytes);
  void measure_some();
  api::Status collect_blobs();
  api::Status match_blobs();
  api::Result<Job> keep(const Upload& upload, const NewJob& row);
  api::Result<Job> submit(const Upload& upload, std::optional<IdempotencyKey> key);
  api::Result<Job> wish(std::string_view id, api::JobEvent event, const StepReason& why);
  void forget_checkpoint(const Job& job) const;
  void tell_change();
  api::Result<bool> is_held();
  api::Status settle(const Job& job, const Lease& lease, const AttemptOutcome& outcome,
                     const std::atomic<bool>& stopping);
  api::Status settle_orphan(const Orphan& orphan);
  api::Status succeed(const Job& job, const Lease& lease, const AttemptOutcome& outcome,
                      const std::atomic<bool>& stopping);
  api::Status wait_for_room_or_fail(const Job& job, const Lease& lease, const AttemptOutcome& outcome);
  api::Status try_again_or_fail(const Job& job, const Lease& lease, const AttemptOutcome& outcome);
  api::Status remove(std::string_view id, JobStore::RemovalOf kind);
  api::Status remove_files_and_row(const std::string& id);

  JobStore& store_;
  const DataFolder& folder_;
  JobRules rules_;
  Clock clock_;
  ClockDoubt clock_doubt_;
  mutable std::mutex parsing_;
  Blobs blobs_;
  std::mutex keeping_;             ///< of blobs, and of their rows
  std::int64_t measured_seq_ = 0;  ///< by the collection of garbage, which goes round
  std::mutex removing_;            ///< two removals of one job would meet half of its files
  std::function<void(const std::string& id)> end_making_ = [](const std::string&) {};
  SubmissionKeys keys_;

  mutable std::mutex state_;  ///< of what follows
  std::condition_variable changed_;
  std::uint64_t changes_ = 0;  ///< counts what may have moved a job
  std::size_t waiters_ = 0;
  bool stopping_ = false;
  bool held_ = false;  ///< the disk was full when a job was to be started last
  WorkerUse use_;
  std::string trouble_;  ///< why no worker can be started
  GarbageReport garbage_;
  std::shared_ptr<const QueuePositions> positions_;
  std::uint64_t positions_of_change_ = 0;
  std::chrono::steady_clock::time_point positions_at_{};
};

}  // namespace server
