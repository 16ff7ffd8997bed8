// What the store keeps of a job, as plain structs. Times are milliseconds since 1970, UTC.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "api/job_options.h"
#include "api/job_report.h"
#include "api/job_status.h"
#include "api/progress_line.h"

namespace server {

enum class InputRole { scene, material, texture, animation };

struct InputFile {
  std::string name;  ///< in the job's input/ folder
  InputRole role = InputRole::texture;
  std::int64_t bytes = 0;
  std::string sha256 = {};  ///< as it came in; empty: not known, of a job of before it was kept
};

/// What clients set, at submission and later.
struct JobSettings {
  std::string name;
  std::uint32_t priority = api::kPriorityDefault;
  api::Labels labels;
  std::optional<std::int64_t> deadline_ms;  ///< not started, or not done, by then: failed
  std::optional<std::int64_t> max_run_ms;   ///< of all attempts together
  std::optional<std::int64_t> ttl_ms;       ///< kept for so long after it finished; none: until removed
  bool pinned = false;                      ///< kept whatever ttl_ms says
};

/// What is given replaces what there was.
void apply(const api::JobOptions& options, JobSettings& settings);

/// By which a submission that comes twice is known.
struct IdempotencyKey {
  std::string key;             ///< 1 to 255 visible characters; of this owner
  std::string request_sha256;  ///< of what was uploaded, 64 hexadecimal digits
};

struct NewJob {
  std::string id;
  JobSettings settings;
  std::uint32_t frame_count = 1;
  double fps = 24;
  std::vector<InputFile> inputs;
  std::string owner = {};                                ///< name of a token; empty: nobody's
  std::optional<api::Forecast> forecast = std::nullopt;  ///< what it is expected to take
  std::optional<IdempotencyKey> key = std::nullopt;
};

/// What there may be at most; INT64_MAX: no end to it.
struct Ceilings {
  std::int64_t queued = INT64_MAX;               ///< jobs, of all owners
  std::int64_t queued_of_one_owner = INT64_MAX;  ///< jobs
  std::int64_t bytes = INT64_MAX;                ///< of all jobs and blobs together
  std::int64_t bytes_of_one_owner = INT64_MAX;
  bool evict = false;  ///< what could be removed to make room does not count in `bytes`
};

struct Job {
  std::int64_t seq = 0;  ///< order of submission, never used twice
  std::string id;
  std::string owner;
  JobSettings settings;
  api::JobState state = api::JobState::queued;
  std::string reason;   ///< stable word: why it is in this state
  std::string message;  ///< the same for people, with what is worth knowing
  std::uint32_t frame_count = 1;
  double fps = 24;
  std::optional<api::Stage> stage;
  double stage_fraction = 0;
  double fraction = 0;
  std::optional<double> seconds_left;  ///< expected by the worker; none: not known, or no worker is at it
  std::uint32_t attempt = 0;
  std::uint32_t attempts_without_progress = 0;
  std::optional<std::uint32_t> key_frame_count;     ///< of kind key; none before the job has succeeded
  std::optional<std::uint32_t> solved_frame_count;  ///< of kind key or check; none likewise
  bool has_report = false;
  std::string report;          ///< the worker's last report as JSON; empty in lists
  std::string forecast;        ///< as JSON; empty: not known
  std::int64_t version = 1;    ///< counts every change
  std::int64_t queued_ms = 0;  ///< since when it waits, for its place in the queue
  std::int64_t run_ms = 0;     ///< of attempts that have ended, since it was submitted or retried
  std::int64_t bytes = 0;      ///< of its files, when last looked at
  std::int64_t created_ms = 0;
  std::int64_t updated_ms = 0;
  std::optional<std::int64_t> started_ms;
  std::optional<std::int64_t> finished_ms;
  std::int64_t used_ms = 0;                ///< when results were asked for last; 0: never
  std::optional<std::int64_t> expires_ms;  ///< removed after it, unless pinned; none: not to be removed
};

struct LabelFilter {
  std::string name;
  std::optional<std::string> value;  ///< none: any
};

/// Which jobs a list has: those that fit all of it.
struct JobFilter {
  std::optional<api::JobState> state = std::nullopt;
  std::optional<std::string> owner = std::nullopt;
  std::optional<std::string> visible_to = std::nullopt;  ///< owner whose jobs alone may be told of; none: all
  std::vector<LabelFilter> labels = {};
  std::optional<std::int64_t> before_seq = std::nullopt;  ///< older than this one
};

/// What is free for another worker.
struct Room {
  std::int64_t memory_bytes = INT64_MAX;
  bool all = true;  ///< no worker runs: the next job is started even where it needs more than there is
};

/// A queued job, as far as its place in the queue depends on it.
struct Waiting {
  std::int64_t seq = 0;
  std::string owner;
  std::uint32_t priority = 0;
  std::int64_t queued_ms = 0;
};

/// How an owner was served, for whose turn it is.
struct OwnerTurn {
  std::string owner;
  std::int64_t running = 0;     ///< jobs with a worker now
  std::int64_t started_ms = 0;  ///< when one was started last; 0: never
};

/// May jobs be started, and why not.
struct QueueSwitch {
  bool paused = false;
  std::string reason;
  std::int64_t changed_ms = 0;
};

/// The right to write for one attempt of a job. Every write of an attempt carries it; once another attempt
/// has begun, the old one's writes are refused.
struct Lease {
  std::int64_t job_seq = 0;
  std::int64_t token = 0;
};

/// A process that cannot be mistaken for a later one with the same pid.
struct ProcessIdentity {
  std::int64_t pid = 0;
  std::int64_t start_ticks = 0;  ///< since boot, field 22 of /proc/PID/stat
  std::string boot_id;
};

struct Claim {
  Job job;
  Lease lease;
};

/// A job that was running when the server ended, and the worker it had, if it got that far.
struct Orphan {
  Job job;
  Lease lease;
  std::optional<ProcessIdentity> worker;
};

/// How an attempt ended, for its row.
struct AttemptEnd {
  std::optional<int> exit_code;
  std::optional<int> signal;
  std::optional<std::int64_t> ran_ms = std::nullopt;  ///< none: as far as the last sign of life tells
};

struct Attempt {
  std::uint32_t number = 0;
  std::int64_t started_ms = 0;
  std::optional<std::int64_t> ended_ms;
  std::string outcome;
  AttemptEnd end;
};

struct Event {
  std::int64_t id = 0;
  std::int64_t at_ms = 0;
  std::optional<api::JobState> from;  ///< none: the job was submitted
  api::JobState to = api::JobState::queued;
  std::string reason;
  std::string message;
};

struct ArtefactFile {
  std::string path;  ///< relative to the job's artefacts/ folder
  std::string media_type;
  std::int64_t bytes = 0;
  std::string sha256;  ///< lower-case hexadecimal
};

/// What the integrity check found of one file.
struct FileLook {
  std::int64_t job_seq = 0;
  bool is_input = false;
  std::string path;    ///< within its folder
  std::string detail;  ///< what is wrong with it; empty: nothing
};

/// How far the integrity check has come, across restarts.
struct IntegrityState {
  std::int64_t ended_ms = 0;   ///< when the last share was done; 0: none was yet
  std::int64_t round_ms = 0;   ///< when all files had been looked at last; 0: not yet
  bool at_inputs = false;      ///< the artefacts are done, inputs are next
  std::int64_t after_seq = 0;  ///< the next share begins after this file
  std::string after_path = {};
};

/// What a successful attempt leaves, committed in one transaction with the step to `succeeded`.
struct Results {
  std::vector<ArtefactFile> artefacts;
  api::KeyFrameReport key_frames;
};

}  // namespace server
