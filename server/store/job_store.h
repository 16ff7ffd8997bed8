// Typed reads and writes of jobs. Every write is one transaction; every step between states goes through one
// private function that checks it, raises the version and leaves an event. Reads have connections of their
// own: they never wait for a write, and see what was written as soon as the write has returned.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/result.h"
#include "server/store/database.h"
#include "server/store/job_rows.h"
#include "server/store/read_pool.h"
#include "server/store/write_mutex.h"

namespace server {

using Clock = std::function<std::int64_t()>;  ///< milliseconds since 1970, UTC

std::int64_t system_clock_ms();

/// The error, not_found, for a job that does not exist.
api::Error no_such_job(std::string_view id);

/// A write that takes longer waits for a disk that does not answer.
inline constexpr std::chrono::seconds kWriteMax{10};

/// Code of the violation in an error, of Fault::internal, that is told to whoever asks for a damaged file.
inline constexpr std::string_view kDamagedFile = "damaged_file";
api::Error damaged_file(std::string_view path, std::string_view detail);

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
  ~JobStore();

  // Clients: job_store.cpp.
  /// With its key, if it has one; wrong_state where that key has a job already. What `most` says is looked at
  /// in the transaction that makes the job, so that many who come at once do not get past it together.
  /// Errors: also those of admit.
  api::Result<Job> insert(const NewJob& job, const Ceilings& most = {});
  /// Would a job of so many bytes be taken now? Errors: out_of_resources (queue full), too_many, over_quota;
  /// job_admission.cpp.
  api::Status admit(std::string_view owner, std::int64_t bytes, const Ceilings& most);
  api::Result<Job> job(std::string_view id);
  api::Result<std::string> owner_of(std::string_view id);
  /// Newest first.
  api::Result<std::vector<Job>> list(const JobFilter& filter, std::int64_t limit);
  api::Result<std::int64_t> count(api::JobState state);
  /// Could something be written now? Nothing is, and it does not wait for who writes: where that takes longer
  /// than kWriteMax the disk does not answer. job_store_health.cpp.
  api::Status can_write();
  /// cancel, pause, resume or retry, as api::kJobReactions says; a wish that is fulfilled already changes
  /// nothing.
  api::Result<Job> wish(std::string_view id, api::JobEvent event, const StepReason& why);
  /// Only what is given in `options`. Errors: changed where `version` is given and is no longer the job's.
  api::Result<Job> change(std::string_view id, const api::JobOptions& options,
                          std::optional<std::int64_t> version);

  // Removal and what is kept: job_retention.cpp.
  /// Marks a finished job as being removed: from now on nobody sees it. The row goes with `erase`. Marking it
  /// again is no error, so that a removal that failed halfway can be asked for again.
  enum class RemovalOf { any, expired, unpinned };
  /// Errors: wrong_state where the job is no longer of that kind: somebody has pinned it, or its time is
  /// longer now.
  api::Status begin_removal(std::string_view id, RemovalOf kind = RemovalOf::any);
  api::Status erase(std::string_view id);
  api::Result<std::vector<std::string>> jobs_being_removed();
  /// Of all jobs that have a row, those being removed included.
  api::Result<std::vector<std::string>> all_ids();
  /// Finished jobs whose time is over, at most `limit`.
  api::Result<std::vector<std::string>> expired(std::int64_t limit);
  api::Status record_bytes(std::int64_t job_seq, std::int64_t bytes);
  struct Unused {
    std::string id;
    std::int64_t bytes = 0;
  };
  /// Finished jobs that are not pinned, those first that have not been used for longest, at most `limit`.
  api::Result<std::vector<Unused>> least_used(std::int64_t limit);
  /// At most `limit` finished jobs of a higher seq, in its order.
  api::Result<std::vector<Job>> finished_after(std::int64_t seq, std::int64_t limit);
  /// Of all jobs and blobs together, or of those of `owner`.
  api::Result<std::int64_t> total_bytes(std::optional<std::string_view> owner = std::nullopt);

  // Blobs, each owner's: blob_rows.cpp.
  /// Errors: also over_quota, where `most` does not leave it room.
  api::Status keep_blob(std::string_view owner, std::string_view sha256, std::int64_t bytes,
                        const Ceilings& most = {});
  /// Is it this owner's? Then it counts as used now; see record_use.
  api::Result<bool> use_blob(std::string_view owner, std::string_view sha256);
  /// Those that have not been used since. -> how many
  api::Result<std::int64_t> forget_blobs(std::int64_t before_ms);
  /// Whosever it is.
  api::Status forget_blob(std::string_view sha256);
  /// The hashes that somebody has.
  api::Result<std::set<std::string, std::less<>>> blobs();
  /// Of all owners, or of one. What two have is counted twice.
  api::Result<std::int64_t> blob_bytes(std::optional<std::string_view> owner = std::nullopt);

  // What is used stays longest. Using it is reading, and waits for no write: job_uses.cpp.
  /// Somebody asked for its results. It is remembered until keep_uses.
  void record_use(std::int64_t job_seq);
  /// Writes what was used since the last time. To be called now and then; also done before the store goes by
  /// it, and at its end. What a crash forgets goes a little earlier.
  api::Status keep_uses();

  // Keys of submissions: job_keys.cpp.
  struct KeyedJob {
    Job job;
    std::string request_sha256;
  };
  /// The job that was submitted under this key after `since_ms`, if there is one.
  api::Result<std::optional<KeyedJob>> job_of_key(std::string_view owner, std::string_view key,
                                                  std::int64_t since_ms);
  api::Status forget_keys(std::int64_t before_ms);

  // The queue: job_queue.cpp.
  api::Result<QueueSwitch> queue();
  api::Result<QueueSwitch> set_queue(bool paused, std::string_view reason);
  /// By state, of all jobs or of those of `owner`.
  api::Result<std::map<api::JobState, std::int64_t>> counts(
      std::optional<std::string_view> owner = std::nullopt);
  /// All queued jobs, for each owner in the order in which they are taken.
  api::Result<std::vector<Waiting>> waiting();
  api::Result<std::vector<OwnerTurn>> owner_turns();
  /// Queued and paused jobs whose deadline has passed become failed. -> how many
  api::Result<std::int64_t> fail_overdue();
  /// The wall clock may have jumped: nobody has been waiting, or was served, later than now, and nobody waits
  /// longer than `wait_ms_max` from now on.
  api::Status mend_times(std::int64_t wait_ms_max = INT64_MAX);

  // Attempts: job_claims.cpp, job_attempts.cpp.
  /// The job whose turn it is, of those that fit into `room`, becomes running under a new lease; none:
  /// nothing is waiting, nothing fits, or the queue is paused.
  api::Result<std::optional<Claim>> claim(const Room& room = {});
  api::Status record_worker(const Lease& lease, const ProcessIdentity& worker);
  /// Records progress and answers the job's state, so that the caller learns of a wish to cancel.
  api::Result<api::JobState> record_progress(const Lease& lease, const api::ProgressLine& line);
  api::Result<Job> leased_job(const Lease& lease);
  api::Status succeed(const Lease& lease, const Results& results, std::string_view report_json);
  api::Status fail(const Lease& lease, const StepReason& why, const AttemptEnd& end,
                   std::string_view report_json);
  /// running -> queued, pause_requested -> paused. `counted`: the attempt counts towards the limit of
  /// attempts without progress.
  api::Status requeue(const Lease& lease, const StepReason& why, const AttemptEnd& end, bool counted,
                      std::int64_t not_before_ms = 0);
  api::Status finish_cancel(const Lease& lease, const AttemptEnd& end);
  /// Of this job, that ended for this reason since it was retried, or made progress, last.
  api::Result<std::int64_t> count_attempts(std::int64_t job_seq, std::string_view reason);
  api::Result<std::vector<Orphan>> orphans();
  /// The wall clock may have jumped while the server was down: nobody waits longer than from now on.
  api::Status forget_waiting_times();

  // Results: job_results.cpp.
  api::Result<std::vector<InputFile>> inputs(std::int64_t job_seq);
  api::Result<std::vector<Attempt>> attempts(std::int64_t job_seq);
  api::Result<std::vector<Event>> events(std::int64_t job_seq);
  api::Result<std::vector<ArtefactFile>> artefacts(std::int64_t job_seq, std::string_view glob = "*");
  /// Errors: not_found; damaged_file where it is known to be damaged.
  api::Result<ArtefactFile> artefact(std::int64_t job_seq, std::string_view path);
  api::Result<std::vector<api::FrameRecord>> frames(std::int64_t job_seq);

  // Files that are no longer what they were: job_damage.cpp.
  /// Errors: damaged_file where one of the job's files that fit `glob` is known to be damaged.
  api::Status must_be_whole(std::int64_t job_seq, std::string_view glob);
  api::Status record_look(const FileLook& look);
  api::Result<std::int64_t> count_damaged();
  api::Result<IntegrityState> integrity();
  api::Status keep_integrity(const IntegrityState& state);

 private:
  struct Step {
    std::int64_t seq;
    api::JobState from;
    api::JobState to;
    StepReason why;
  };
  struct Chosen {
    std::int64_t seq = 0;
    std::string id;
    std::string owner;
  };

  /// When it was used last.
  struct Uses {
    std::map<std::int64_t, std::int64_t> of_jobs;                          ///< by seq
    std::map<std::pair<std::string, std::string>, std::int64_t> of_blobs;  ///< by owner and hash
  };

  JobStore(Database database, std::unique_ptr<ReadPool> readers, Clock clock)
      : database_(std::move(database)), readers_(std::move(readers)), clock_(std::move(clock)) {}

  api::Status step(const Step& step);
  api::Status enter_queue(std::int64_t seq);
  api::Status leave_word(const Job& job);
  static api::Status admit_in(Database& database, std::string_view owner, std::int64_t bytes,
                              const Ceilings& most);
  static api::Status admit_to_queue(Database& database, std::string_view owner, const Ceilings& most);
  static api::Result<std::int64_t> total_bytes_in(Database& database, std::optional<std::string_view> owner);
  static api::Result<std::int64_t> unused_bytes_in(Database& database);
  static api::Result<std::int64_t> blob_bytes_in(Database& database, std::optional<std::string_view> owner);
  api::Status insert_row(const NewJob& job, std::int64_t now);
  api::Status insert_labels(std::int64_t seq, const api::Labels& labels);
  static api::Status read_labels(Database& database, std::span<Job> jobs);
  api::Status write_settings(const Job& job);
  api::Result<std::optional<Chosen>> choose(const Room& room, std::int64_t now);
  api::Result<Lease> begin_attempt(const Chosen& chosen, std::int64_t now);
  api::Status end_attempt(const Lease& lease, std::string_view outcome, const AttemptEnd& end);
  api::Status refuse_canceled(const Lease& lease);
  api::Status leave_running(const Lease& lease, api::JobEvent event, const StepReason& why,
                            const AttemptEnd& end, std::string_view report_json);
  api::Status insert_results(std::int64_t job_seq, const Results& results);
  static api::Result<QueueSwitch> queue_in(Database& database);
  static api::Result<std::vector<OwnerTurn>> owner_turns_in(Database& database);
  static api::Result<Job> job_in(Database& database, std::string_view id);
  static api::Result<Job> leased_job_in(Database& database, const Lease& lease);

  api::Status keep_uses_locked();
  api::Status write_uses(const Uses& uses);

  WriteMutex mutex_;
  Database database_;  ///< to write; under mutex_
  const std::unique_ptr<ReadPool> readers_;
  Clock clock_;
  std::mutex using_;
  Uses uses_;  ///< under using_
};

}  // namespace server
