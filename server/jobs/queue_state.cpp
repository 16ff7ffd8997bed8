// The part of JobService that sees the queue as a whole, and what happens by itself.
#include <algorithm>
#include <utility>

#include "api/fault_point.h"
#include "server/jobs/folder_size.h"
#include "server/jobs/job_service.h"
#include "server/log.h"
#include "server/store/turns.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::int64_t kRemovedAtOnceMax = 100;
// A long queue is not put in order for every request that looks at it, a short one is.
constexpr std::size_t kShortQueue = 500;
constexpr std::chrono::milliseconds kPositionsKept{500};
// Priorities age: after so long the order of owners may be another one though nothing happened.
constexpr std::chrono::seconds kPositionsAge{10};

}  // namespace

api::Result<QueueReport> JobService::queue(const Viewer& viewer) {
  const auto queue = store_.queue();
  if (!queue) return queue.error();
  auto counts = store_.counts(viewer.sees_all ? std::nullopt : std::optional(viewer.owner));
  if (!counts) return counts.error();
  const std::lock_guard lock(state_);
  const api::Status room = has_room(folder_.jobs());
  return QueueReport{*queue, std::move(*counts), use_, rules_.budget, room ? trouble_ : room.error().message};
}

api::Result<QueueReport> JobService::pause_queue(std::string_view reason) {
  const auto paused = store_.set_queue(true, reason);
  if (!paused) return paused.error();
  return queue();
}

api::Result<QueueReport> JobService::resume_queue() {
  const auto resumed = store_.set_queue(false, "");
  if (!resumed) return resumed.error();
  rules_.work_arrived();
  return queue();
}

std::shared_ptr<const QueuePositions> JobService::queue_positions() {
  const std::lock_guard lock(state_);
  const auto age = SteadyClock::now() - positions_at_;
  const bool same = positions_ && positions_of_change_ == changes_ && age < kPositionsAge;
  const bool young = positions_ && positions_->size() > kShortQueue && age < kPositionsKept;
  if (same || young) return positions_;
  const std::uint64_t change = changes_;
  const auto waiting = store_.waiting();
  const auto turns = store_.owner_turns();
  // Nothing depends on it: a client that is told no place asks again.
  if (!waiting || !turns) return std::make_shared<const QueuePositions>();
  positions_ = std::make_shared<const QueuePositions>(server::queue_positions(*waiting, *turns, clock_()));
  positions_of_change_ = change;
  positions_at_ = SteadyClock::now();
  return positions_;
}

void JobService::tell_change() {
  {
    const std::lock_guard lock(state_);
    ++changes_;
  }
  changed_.notify_all();
}

void JobService::set_use(const WorkerUse& use) {
  const std::lock_guard lock(state_);
  use_ = use;
}

void JobService::set_trouble(std::string why) {
  const std::lock_guard lock(state_);
  trouble_ = std::move(why);
}

api::Result<Job> JobService::wait_until_final(std::string_view id, std::chrono::milliseconds patience) {
  const auto deadline = SteadyClock::now() + patience;
  std::unique_lock lock(state_);
  if (waiters_ >= rules_.waiters_max)
    return api::Error{api::Fault::out_of_resources, "too many requests wait already"};
  ++waiters_;
  const auto waited = [&]() -> api::Result<Job> {
    while (true) {
      const std::uint64_t seen = changes_;
      lock.unlock();
      auto job = store_.job(id);
      lock.lock();
      if (!job || api::is_final(job->state) || stopping_) return job;
      const bool moved = changed_.wait_until(lock, deadline, [&] { return changes_ != seen || stopping_; });
      if (!moved) return job;
    }
  };
  auto job = waited();
  --waiters_;
  return job;
}

void JobService::stop_waiting() {
  {
    const std::lock_guard lock(state_);
    stopping_ = true;
  }
  changed_.notify_all();
}

api::Status JobService::collect_garbage() {
  folder_.lay_ballast();
  if (api::Status mended = store_.mend_times(rules_.disk_full_wait_ms_max); !mended) return mended;
  (void)store_.keep_uses();  // on a full disk room is to be made all the same
  if (clock_doubt_.is_doubtful()) return api::Done{};
  if (api::Status forgotten = store_.forget_keys(clock_() - rules_.key_ms); !forgotten) return forgotten;
  {
    const std::lock_guard lock(keeping_);
    if (api::Status collected = collect_blobs(); !collected) return collected;
  }
  const auto expired = store_.expired(kRemovedAtOnceMax);
  if (!expired) return expired.error();
  std::int64_t jobs = 0;
  std::int64_t bytes = 0;
  bool all = true;
  for (const std::string& id : *expired) {
    const FolderSize size = size_of_folder(folder_.job(id));
    const api::Status removed = remove(id, JobStore::RemovalOf::expired);
    // Gone, pinned, or to be kept for longer, in the moment since.
    if (!removed &&
        (removed.error().fault == api::Fault::wrong_state || removed.error().fault == api::Fault::not_found))
      continue;
    if (!removed) {
      all = false;
      log_line(id + " is over its time but cannot be removed: " + removed.error().message);
      continue;
    }
    api::fault_point("expired_removed");
    log_line(id + ": removed, its time was over");
    ++jobs;
    bytes += size.bytes;
  }
  measure_some();
  // Results came in since room was made for what was sent.
  if (const api::Status room = make_room(0); !room && room.error().fault != api::Fault::over_quota)
    return room;
  const std::lock_guard lock(state_);
  if (all) garbage_.last_ms = clock_();
  garbage_.jobs += jobs;
  garbage_.bytes += bytes;
  return api::Done{};
}

GarbageReport JobService::garbage() const {
  const std::lock_guard lock(state_);
  return garbage_;
}

}  // namespace server
