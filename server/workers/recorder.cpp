#include "server/workers/recorder.h"

#include <algorithm>
#include <utility>

#include "server/log.h"
#include "server/workers/child_process.h"

namespace server {

Recorder::Recorder(JobService& jobs, RecorderRules rules, std::function<void()> recorded)
    : jobs_(jobs), rules_(rules), recorded_(std::move(recorded)) {}

void Recorder::start(std::vector<Orphan> orphans) {
  orphans_ = std::move(orphans);
  catch_up();
  at_work_ = std::max<std::size_t>(rules_.at_once, 1);
  threads_.emplace_back([this] { run(); });
  while (threads_.size() < rules_.at_once) threads_.emplace_back([this] { run_beside(); });
}

void Recorder::add(EndedAttempt ended) {
  {
    const std::lock_guard lock(mutex_);
    new_.push_back(std::move(ended));
  }
  added_.notify_one();
}

void Recorder::stop() {
  {
    std::unique_lock lock(mutex_);
    stopping_ = true;
    added_.notify_all();
    ended_.wait_for(lock, rules_.stop_patience, [this] { return at_work_ == 0; });
  }
  aborted_ = true;
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

/// None: there was nothing until then, or the server stops and nothing is left.
std::optional<EndedAttempt> Recorder::next(SteadyClock::time_point until) {
  std::unique_lock lock(mutex_);
  added_.wait_until(lock, until, [this] { return stopping_ || !new_.empty(); });
  if (new_.empty()) return std::nullopt;
  EndedAttempt ended = std::move(new_.front());
  new_.pop_front();
  return ended;
}

void Recorder::record_or_keep(EndedAttempt ended) {
  if (!record(ended)) {
    const std::lock_guard lock(mutex_);
    unrecorded_.push_back(std::move(ended));
  }
  recorded_();
}

void Recorder::run() {
  const auto stopping = [this] {
    const std::lock_guard lock(mutex_);
    return stopping_ && new_.empty();
  };
  while (!stopping()) {
    if (auto ended = next(std::min(catch_up_at_, collect_at_))) record_or_keep(std::move(*ended));
    if (SteadyClock::now() >= catch_up_at_) catch_up();
    if (!stopping() && SteadyClock::now() >= collect_at_) collect_garbage();
  }
  const std::lock_guard lock(mutex_);
  --at_work_;
  ended_.notify_all();
}

void Recorder::run_beside() {
  constexpr std::chrono::hours kLong{1};
  for (bool stopping = false; !stopping;) {
    if (auto ended = next(SteadyClock::now() + kLong)) record_or_keep(std::move(*ended));
    const std::lock_guard lock(mutex_);
    stopping = stopping_ && new_.empty();
  }
  const std::lock_guard lock(mutex_);
  --at_work_;
  ended_.notify_all();
}

// The database may be unable to write for a while (full disk). That must neither end the service nor hold up
// the other jobs; a job whose end is not written stays `running` until then, or until the next start.
void Recorder::catch_up() {
  const auto before = orphans_.size();
  std::erase_if(orphans_, [this](const Orphan& orphan) { return take_up(orphan); });
  std::vector<EndedAttempt> again;
  {
    const std::lock_guard lock(mutex_);
    again.swap(unrecorded_);
  }
  for (EndedAttempt& ended : again) record_or_keep(std::move(ended));
  if (orphans_.size() != before) recorded_();
  catch_up_at_ = SteadyClock::now() + rules_.retry_every;
}

void Recorder::collect_garbage() {
  if (const api::Status collected = jobs_.collect_garbage(); !collected)
    complain("cannot look for jobs whose time is over: " + collected.error().message);
  collect_at_ = SteadyClock::now() + rules_.collect_every;
}

bool Recorder::take_up(const Orphan& orphan) {
  // Dead first, queued after: two workers must never share a job's folder.
  api::Status taken = orphan.worker ? kill_and_confirm(*orphan.worker) : api::Status(api::Done{});
  if (taken) taken = jobs_.take_up_again(orphan);
  if (!taken && taken.error().fault != api::Fault::wrong_state) {
    complain(orphan.job.id + " cannot be taken up again yet: " + taken.error().message);
    return false;
  }
  log_line(orphan.job.id + " was " + std::string(api::name_of(orphan.job.state)) +
           " when the last server ended; taken up again");
  return true;
}

bool Recorder::record(EndedAttempt& ended) {
  const api::Status recorded = jobs_.end_attempt(ended.lease, ended.outcome, aborted_);
  if (!recorded && recorded.error().fault != api::Fault::wrong_state) {
    --ended.outcome.looks_left;
    complain(ended.id + " cannot record the end of an attempt yet: " + recorded.error().message);
    return false;
  }
  const auto job = jobs_.job(ended.id);
  if (!job) return true;
  const std::string why = job->reason.empty() ? "" : " (" + job->reason + ")";
  log_line(job->id + ": " + std::string(api::name_of(job->state)) + why);
  return true;
}

void Recorder::complain(const std::string& trouble) {
  const std::lock_guard lock(mutex_);
  if (trouble != last_complaint_) log_line(trouble);
  last_complaint_ = trouble;
}

}  // namespace server
