#include "server/jobs/job_service.h"

#include <malloc.h>

#include <system_error>
#include <utility>

#include "server/artefacts/files.h"
#include "server/jobs/collect_results.h"
#include "server/log.h"

namespace server {
namespace {

using api::Fault;
using api::JobState;

}  // namespace

JobService::JobService(JobStore& store, const DataFolder& folder, JobRules rules, Clock clock)
    : store_(store), folder_(folder), rules_(std::move(rules)), clock_(std::move(clock)) {}

api::Result<Job> JobService::submit(const Upload& upload) {
  const auto row = check(upload);
  if (!row) {
    discard(upload);
    return row.error();
  }
  auto job = keep(upload, *row);
  if (!job) return job;
  rules_.work_arrived();
  return job;
}

api::Result<api::JobReport> JobService::validate(const Upload& upload) {
  const auto validated = [&]() -> api::Result<api::JobReport> {
    const std::filesystem::path folder = folder_.upload(upload.id);
    if (const api::Status fine = rules_.check(folder); !fine) return fine.error();
    if (const auto row = read_request(upload); !row) return row.error();
    return read_check_report(folder);
  };
  auto report = validated();
  discard(upload);
  return report;
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
    return NewJob{upload.id, request->name, request->frame_count, request->fps, upload.inputs};
  };
  auto job = read();
  ::malloc_trim(0);
  return job;
}

api::Result<NewJob> JobService::check(const Upload& upload) const {
  const auto waiting = store_.count(JobState::queued);
  if (!waiting) return waiting.error();
  if (*waiting >= rules_.queued_max)
    return api::Error{Fault::out_of_resources,
                      "the queue is full: " + std::to_string(*waiting) + " jobs are waiting"};
  // The check first: it says what is wrong with every file.
  if (const api::Status fine = rules_.check(folder_.upload(upload.id)); !fine) return fine.error();
  return read_request(upload);
}

api::Result<Job> JobService::keep(const Upload& upload, const NewJob& row) {
  const std::filesystem::path from = folder_.upload(upload.id);
  const std::filesystem::path to = folder_.job(upload.id);
  std::error_code ignored;
  std::filesystem::remove(from / "check.json", ignored);  // it has served
  // The order matters: files and names durable, then the row. A crash in between leaves a folder without a
  // row, which the next start removes; never a row without files.
  for (const auto& path : {from / "input", from})
    if (const api::Status synced = sync_folder(path); !synced) {
      discard(upload);
      return synced.error();
    }
  if (const api::Status moved = move_folder(from, to); !moved) {
    discard(upload);
    (void)remove_tree(to);
    return moved.error();
  }
  auto job = store_.insert(row);
  if (!job) (void)remove_tree(to);
  return job;
}

api::Result<JobPage> JobService::list(std::optional<JobState> state, std::optional<std::int64_t> before,
                                      std::int64_t limit) {
  // One more than asked for tells whether another page follows.
  auto jobs = store_.list(state, before, limit + 1);
  if (!jobs) return jobs.error();
  JobPage page{std::move(*jobs), std::nullopt};
  if (static_cast<std::int64_t>(page.jobs.size()) > limit) {
    page.jobs.pop_back();
    page.next = page.jobs.back().seq;
  }
  return page;
}

api::Result<Job> JobService::cancel(std::string_view id) {
  auto job = store_.cancel(id);
  if (job && job->state == JobState::cancel_requested) rules_.cancel_requested();
  if (job && job->state == JobState::canceled) forget_checkpoint(*job);
  return job;
}

api::Status JobService::remove(std::string_view id) {
  const std::lock_guard lock(removing_);
  if (api::Status begun = store_.begin_removal(id); !begun) return begun;
  return remove_files_and_row(std::string(id));
}

api::Status JobService::remove_files_and_row(const std::string& id) {
  if (api::Status removed = remove_tree(folder_.job(id)); !removed) return removed;
  if (api::Status synced = sync_folder(folder_.jobs()); !synced) return synced;
  return store_.erase(id);
}

api::Result<ArtefactFile> JobService::artefact(const Job& job, std::string_view path) {
  if (job.state != JobState::succeeded)
    return api::Error{Fault::not_found, "not made yet: the job is " + std::string(api::name_of(job.state))};
  return store_.artefact(job.seq, path);
}

api::Result<std::vector<api::FrameRecord>> JobService::frames(const Job& job) {
  auto frames = store_.frames(job.seq);
  // `job` was read earlier: by now somebody may have removed it, and its rows with it.
  if (frames && frames->size() != job.frame_count)
    return api::Error{Fault::not_found, "the job has no frames any more"};
  return frames;
}

// What fails here is tried again at the next start, or when it is next asked for: it is no reason not to
// serve.
api::Status JobService::clean_up() {
  const auto unfinished = store_.jobs_being_removed();
  if (!unfinished) return unfinished.error();
  for (const std::string& id : *unfinished)
    if (const api::Status removed = remove_files_and_row(id); !removed)
      log_line(id + " cannot be removed yet: " + removed.error().message);
  const auto known = store_.all_ids();
  if (!known) return known.error();
  if (const api::Status removed = folder_.remove_leftovers(*known); !removed)
    log_line("leftovers cannot be removed yet: " + removed.error().message);
  if (const api::Status forgotten = store_.forget_waiting_times(); !forgotten)
    log_line("waiting times stay: " + forgotten.error().message);
  return api::Done{};
}

}  // namespace server
