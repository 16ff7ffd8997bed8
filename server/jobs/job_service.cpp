#include "server/jobs/job_service.h"

#include <malloc.h>

#include <system_error>
#include <utility>

#include "api/fault_point.h"
#include "server/artefacts/files.h"
#include "server/jobs/collect_results.h"
#include "server/log.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

api::Result<api::JobOptions> read_options(const Upload& upload, std::int64_t now_ms) {
  if (upload.options.empty()) return api::JobOptions{};
  auto options = api::parse_job_options(upload.options);
  if (!options) return options;
  if (const api::Status ahead = refuse_past_deadline(*options, now_ms, "options"); !ahead)
    return ahead.error();
  return options;
}

std::int64_t bytes_of(const Upload& upload) {
  std::int64_t bytes = 0;
  for (const InputFile& input : upload.inputs) bytes += input.bytes;
  return bytes;
}

}  // namespace

api::Status refuse_past_deadline(const api::JobOptions& options, std::int64_t now_ms, std::string_view file) {
  if (!options.deadline_ms.value || *options.deadline_ms.value > now_ms) return api::Done{};
  const std::string detail = "is in the past";
  return api::Error{Fault::invalid_request,
                    "the deadline " + detail,
                    {{std::string(file), "/deadline", 0, 0, "out_of_range", detail}}};
}

JobService::JobService(JobStore& store, const DataFolder& folder, JobRules rules, Clock clock, Clock steady)
    : store_(store),
      folder_(folder),
      rules_(std::move(rules)),
      clock_(std::move(clock)),
      clock_doubt_(clock_, std::move(steady)),
      blobs_(folder.blobs()) {}

api::Result<Job> JobService::submit(const Upload& upload) {
  return submit(upload, std::nullopt);
}

api::Result<Job> JobService::submit(const Upload& upload, std::optional<IdempotencyKey> key) {
  api::fault_point("upload_received");
  auto row = check(upload);
  if (!row) {
    discard(upload);
    return row.error();
  }
  api::fault_point("upload_checked");
  // Not before the job is known to be right: it may cost others theirs.
  if (const api::Status room = make_room(bytes_of(upload)); !room) {
    discard(upload);
    return room.error();
  }
  row->key = std::move(key);
  auto job = keep(upload, *row);
  if (!job) return job;
  tell_change();
  rules_.work_arrived();
  return job;
}

api::Result<api::JobReport> JobService::validate(const Upload& upload) {
  const auto validated = [&]() -> api::Result<api::JobReport> {
    const std::filesystem::path folder = folder_.upload(upload.id);
    if (const auto options = read_options(upload, clock_()); !options) return options.error();
    if (const api::Status fine = rules_.check(folder); !fine) return fine.error();
    if (const auto row = read_request(upload); !row) return row.error();
    return read_check_report(folder);
  };
  auto report = validated();
  discard(upload);
  return report;
}

api::Result<FileHandle> JobService::preview(const Upload& upload) {
  const auto previewed = [&]() -> api::Result<FileHandle> {
    const std::filesystem::path folder = folder_.upload(upload.id);
    if (const auto options = read_options(upload, clock_()); !options) return options.error();
    if (const api::Status fine = rules_.preview(folder); !fine) return fine.error();
    auto file = open_below(folder, "preview/preview.npz");
    if (!file) return api::Error{Fault::internal, "the check of the job left no preview"};
    return file;
  };
  auto preview = previewed();
  discard(upload);
  return preview;
}

void JobService::discard(const Upload& upload) const {
  // What cannot be removed now is removed at the next start.
  (void)remove_tree(folder_.upload(upload.id));
}

// A small file can become a large document, so there is only one at a time, and none stays; what it took is
// given back, because glibc would keep it for each of the many threads.
api::Result<NewJob> JobService::read_request(const Upload& upload) const {
  const std::lock_guard lock(parsing_);
  const auto read = [&]() -> api::Result<NewJob> {
    const std::filesystem::path input = folder_.upload(upload.id) / "input";
    const auto bytes = read_below(input, "animation.json", std::int64_t{api::kAnimationBytesMax});
    if (!bytes) return bytes.error();
    const auto request = api::parse_job_request(*bytes);
    if (!request) return request.error();
    NewJob row{upload.id, {}, request->frame_count, request->fps, upload.inputs};
    row.settings.name = request->name;
    row.owner = upload.owner;
    return row;
  };
  auto job = read();
  ::malloc_trim(0);
  return job;
}

api::Result<NewJob> JobService::check(const Upload& upload) {
  if (const api::Status admitted = admit(upload.owner, bytes_of(upload)); !admitted) return admitted.error();
  const auto options = read_options(upload, clock_());
  if (!options) return options.error();
  // The worker's check first: it says what is wrong with every file.
  const std::filesystem::path folder = folder_.upload(upload.id);
  if (const api::Status fine = rules_.check(folder); !fine) return fine.error();
  auto row = read_request(upload);
  if (!row) return row;
  row->forecast = read_check_report(folder).forecast;
  row->settings.ttl_ms = rules_.ttl_ms;
  apply(*options, row->settings);
  return row;
}

api::Result<Job> JobService::keep(const Upload& upload, const NewJob& row) {
  const std::filesystem::path from = folder_.upload(upload.id);
  const std::filesystem::path to = folder_.job(upload.id);
  std::error_code ignored;
  std::filesystem::remove(from / "check.json", ignored);  // it has served
  // The order matters: files and names durable, then the row. A crash in between leaves a folder without a
  // row, which the next start removes; never a row without files.
  if (const api::Status moved = move_folder(from, to); !moved) {
    discard(upload);
    (void)remove_tree(to);
    return moved.error();
  }
  api::fault_point("folder_moved");
  auto job = store_.insert(row, ceilings());
  // Others may have taken the room that was made.
  for (int tries = 0; rules_.evict && !job && job.error().fault == Fault::over_quota && tries < 8; ++tries) {
    if (!make_room(bytes_of(upload))) break;
    job = store_.insert(row, ceilings());
  }
  api::fault_point("job_committed");
  if (!job) (void)remove_tree(to);
  return job;
}

// What fails here is tried again at the next start, or when it is next asked for: it is no reason not to
// serve.
api::Status JobService::clean_up() {
  folder_.lay_ballast();
  const auto unfinished = store_.jobs_being_removed();
  if (!unfinished) return unfinished.error();
  for (const std::string& id : *unfinished)
    if (const api::Status removed = remove_files_and_row(id); !removed)
      log_line(id + " cannot be removed yet: " + removed.error().message);
  const auto known = store_.all_ids();
  if (!known) return known.error();
  if (const api::Status removed = folder_.remove_leftovers(*known); !removed)
    log_line("leftovers cannot be removed yet: " + removed.error().message);
  if (const api::Status matched = match_blobs(); !matched)
    log_line("blobs cannot be looked through: " + matched.error().message);
  if (const api::Status forgotten = store_.forget_waiting_times(); !forgotten)
    log_line("waiting times stay: " + forgotten.error().message);
  return api::Done{};
}

}  // namespace server
