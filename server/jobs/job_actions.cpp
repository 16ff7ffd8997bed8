// The part of JobService that does what clients wish with jobs that exist.
#include <utility>

#include "api/fault_point.h"
#include "server/artefacts/files.h"
#include "server/jobs/folder_size.h"
#include "server/jobs/job_service.h"
#include "server/log.h"

namespace server {

using api::Fault;
using api::JobEvent;
using api::JobState;

api::Status JobService::must_see(std::string_view id, const Viewer& viewer) {
  if (viewer.sees_all) return api::Done{};
  const auto owner = store_.owner_of(id);
  if (!owner) return owner.error();
  if (*owner == viewer.owner) return api::Done{};
  return no_such_job(id);
}

api::Result<JobPage> JobService::list(const JobFilter& filter, std::int64_t limit) {
  // One more than asked for tells whether another page follows.
  auto jobs = store_.list(filter, limit + 1);
  if (!jobs) return jobs.error();
  JobPage page{std::move(*jobs), std::nullopt};
  if (static_cast<std::int64_t>(page.jobs.size()) > limit) {
    page.jobs.pop_back();
    page.next = page.jobs.back().seq;
  }
  return page;
}

api::Result<Job> JobService::wish(std::string_view id, JobEvent event, const StepReason& why) {
  auto job = store_.wish(id, event, why);
  if (job) tell_change();
  return job;
}

api::Result<Job> JobService::cancel(std::string_view id) {
  auto job = wish(id, JobEvent::cancel, {"canceled", "on request"});
  if (job && job->state == JobState::cancel_requested) rules_.cancel_requested();
  return job;
}

api::Result<Job> JobService::pause(std::string_view id) {
  auto job = wish(id, JobEvent::pause, {"paused", "on request"});
  if (job && job->state == JobState::pause_requested) rules_.cancel_requested();
  return job;
}

api::Result<Job> JobService::resume(std::string_view id) {
  auto job = wish(id, JobEvent::resume, {"resumed", "on request"});
  if (job) rules_.work_arrived();
  return job;
}

api::Result<Job> JobService::retry(std::string_view id, bool from_start) {
  // Neither may a removal, nor another retry whose worker would start meanwhile, meet half of the files.
  const std::lock_guard lock(removing_);
  if (from_start) {
    const auto before = store_.job(id);
    if (!before) return before;
    if (before->state != JobState::failed && before->state != JobState::canceled)
      return api::Error{Fault::wrong_state, "the job is " + std::string(api::name_of(before->state)) +
                                                "; only a failed or canceled one can start anew"};
    for (const char* part : {"checkpoint", "artefacts"})
      if (const api::Status removed = remove_tree(folder_.job(before->id) / part); !removed)
        return removed.error();
  }
  auto job = wish(id, JobEvent::retry, {"retried", "on request"});
  if (job) rules_.work_arrived();
  return job;
}

api::Result<Job> JobService::change(std::string_view id, const api::JobOptions& options,
                                    std::optional<std::int64_t> version) {
  if (const api::Status ahead = refuse_past_deadline(options, clock_(), "body"); !ahead) return ahead.error();
  auto job = store_.change(id, options, version);
  if (job) tell_change();
  return job;
}

api::Status JobService::remove(std::string_view id) {
  return remove(id, JobStore::RemovalOf::any);
}

api::Status JobService::remove(std::string_view id, JobStore::RemovalOf kind) {
  const std::lock_guard lock(removing_);
  // On a full disk nothing can be written, and what cannot be written down cannot be removed.
  const auto with_ballast = [&](const auto& write) -> api::Status {
    api::Status done = write();
    if (done || done.error().fault != Fault::disk_full || !folder_.drop_ballast()) return done;
    log_line("the disk is full: the room that was kept for removals is used now");
    return write();
  };
  if (api::Status begun = with_ballast([&] { return store_.begin_removal(id, kind); }); !begun) return begun;
  api::fault_point("removal_marked");
  end_making_(std::string(id));
  return with_ballast([&] { return remove_files_and_row(std::string(id)); });
}

api::Status JobService::remove_files_and_row(const std::string& id) {
  if (api::Status removed = remove_tree(folder_.job(id)); !removed) return removed;
  if (api::Status synced = sync_folder(folder_.jobs()); !synced) return synced;
  api::fault_point("files_removed");
  return store_.erase(id);
}

api::Result<Removal> JobService::what_remove_deletes(std::string_view id) {
  const auto job = store_.job(id);
  if (!job) return job.error();
  if (!api::is_final(job->state))
    return api::Error{Fault::wrong_state, "the job is " + std::string(api::name_of(job->state)) +
                                              "; cancel it first, then remove it"};
  const FolderSize size = size_of_folder(folder_of(*job));
  return Removal{size.bytes, size.files};
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

}  // namespace server
