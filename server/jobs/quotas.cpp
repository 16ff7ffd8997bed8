// The part of JobService that knows how much may be kept, and makes room.
#include "server/jobs/job_service.h"
#include "server/log.h"

namespace server {
namespace {

using api::Fault;

constexpr std::int64_t kUsedEveryMs = 60'000;  // a job's last use is written no more often
constexpr std::int64_t kEvictedAtOnce = 16;
constexpr std::int64_t kMeasuredAtOnce = 20;

}  // namespace

Ceilings JobService::ceilings() const {
  return {rules_.queued_max, rules_.queued_of_one_owner_max, rules_.bytes_max, rules_.bytes_of_one_owner_max};
}

api::Status JobService::admit(std::string_view owner, std::int64_t bytes) {
  Ceilings most = ceilings();
  most.evict = rules_.evict;
  return store_.admit(owner, bytes, most);
}

api::Status JobService::within_quota(std::string_view owner, std::int64_t bytes) {
  return store_.admit(owner, bytes,
                      {INT64_MAX, INT64_MAX, rules_.bytes_max, rules_.bytes_of_one_owner_max, rules_.evict});
}

api::Status JobService::make_room(std::int64_t bytes) {
  if (!rules_.evict || rules_.bytes_max == INT64_MAX) return api::Done{};
  while (true) {
    auto kept = store_.total_bytes();
    if (!kept) return kept.error();
    if (*kept + bytes <= rules_.bytes_max) return api::Done{};
    const auto unused = store_.least_used(kEvictedAtOnce);
    if (!unused) return unused.error();
    bool any = false;
    for (const JobStore::Unused& job : *unused) {
      if (*kept + bytes <= rules_.bytes_max) return api::Done{};
      // Gone or started anew meanwhile: no harm. A file that cannot be removed: the job is marked, and the
      // next start tries again.
      if (const api::Status removed = remove(job.id, JobStore::RemovalOf::unpinned); !removed) {
        log_line(job.id + " cannot be evicted: " + removed.error().message);
        if (removed.error().fault == Fault::disk_full) return removed;
        continue;
      }
      any = true;
      log_line(job.id + ": evicted, to make room; nobody had used it for longest");
      *kept -= job.bytes;
      const std::lock_guard lock(state_);
      ++garbage_.evicted_jobs;
      garbage_.evicted_bytes += job.bytes;
    }
    if (!any) return store_.admit("", bytes, {INT64_MAX, INT64_MAX, rules_.bytes_max});
  }
}

void JobService::use(const Job& job) {
  if (!api::is_final(job.state) || clock_() - job.used_ms < kUsedEveryMs) return;
  store_.record_use(job.seq);
}

// A crash between a view and its bytes must not count for ever, nor what earlier versions did not count: all
// are measured again, a few at a time.
void JobService::measure_some() {
  const auto jobs = store_.finished_after(measured_seq_, kMeasuredAtOnce);
  if (!jobs) return;
  for (const Job& job : *jobs) record_bytes(job);
  measured_seq_ = jobs->empty() ? 0 : jobs->back().seq;
}

}  // namespace server
