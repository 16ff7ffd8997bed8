#include "server/workers/maker.h"

#include <algorithm>
#include <utility>

#include "server/log.h"

namespace server {

Maker::Maker(std::size_t at_once, std::size_t waiting_max, std::chrono::milliseconds room_after)
    : waiting_max_(waiting_max), room_after_(room_after) {
  for (std::size_t k = 0; k < at_once; ++k) threads_.emplace_back([this] { run(); });
}

api::Status Maker::ask(const std::string& key, Work work) {
  {
    const std::lock_guard lock(mutex_);
    Look& look = looks_[key];
    if (look.state == State::waiting || look.state == State::making) return api::Done{};
    if (waiting_.size() >= waiting_max_) {
      if (look.state == State::unknown) looks_.erase(key);
      return api::Error{api::Fault::out_of_resources,
                        std::to_string(waiting_max_) + " views and videos are waiting to be made already"};
    }
    std::erase(failures_, key);
    look = {State::waiting, {}};
    waiting_.push_back({key, std::move(work)});
  }
  changed_.notify_one();
  return api::Done{};
}

Maker::Look Maker::look(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = looks_.find(key);
  return found == looks_.end() ? Look{} : found->second;
}

bool Maker::forget(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = looks_.find(key);
  if (found == looks_.end()) return true;
  if (found->second.state == State::making) return false;
  std::erase_if(waiting_, [&](const Task& task) { return task.key == key; });
  std::erase(failures_, key);
  looks_.erase(found);
  return true;
}

void Maker::end_all(const std::string& prefix) {
  const auto is_meant = [&](const std::string& key) { return key.starts_with(prefix); };
  std::unique_lock lock(mutex_);
  std::erase_if(waiting_, [&](const Task& task) { return is_meant(task.key); });
  std::erase_if(failures_, is_meant);
  for (auto& [key, stop] : made_)
    if (is_meant(key)) stop = true;
  changed_.wait(lock, [&] {
    return std::none_of(made_.begin(), made_.end(), [&](const auto& made) { return is_meant(made.first); });
  });
  std::erase_if(looks_, [&](const auto& look) { return is_meant(look.first); });
}

void Maker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (auto& [key, stop] : made_) stop = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

// With mutex_ held. `forgotten`: somebody wants it no more.
void Maker::end(Task task, const api::Status& status, bool forgotten) {
  if (status || forgotten || status.error().fault == api::Fault::stopped) {
    looks_.erase(task.key);
    return;
  }
  log_line(task.key + ": " + status.error().message);
  if (status.error().fault == api::Fault::disk_full) {
    looks_[task.key] = {State::waiting, status.error()};
    task.not_before = SteadyClock::now() + room_after_;
    waiting_.push_back(std::move(task));
    return;
  }
  looks_[task.key] = {State::failed, status.error()};
  failures_.push_back(task.key);
  if (failures_.size() <= kFailuresMax) return;
  looks_.erase(failures_.front());
  failures_.pop_front();
}

// With mutex_ held by `lock`.
std::optional<Maker::Task> Maker::next(std::unique_lock<std::mutex>& lock) {
  while (!stopping_) {
    const auto now = SteadyClock::now();
    const auto ripe = std::find_if(waiting_.begin(), waiting_.end(),
                                   [&](const Task& task) { return task.not_before <= now; });
    if (ripe != waiting_.end()) {
      Task task = std::move(*ripe);
      waiting_.erase(ripe);
      return task;
    }
    if (waiting_.empty())
      changed_.wait(lock);
    else
      changed_.wait_for(lock, room_after_);
  }
  return std::nullopt;
}

void Maker::run() {
  std::unique_lock lock(mutex_);
  while (auto task = next(lock)) {
    looks_[task->key].state = State::making;
    const std::atomic<bool>& stop = made_[task->key];
    lock.unlock();
    const api::Status status = task->work(stop);
    lock.lock();
    const bool forgotten = stop;
    made_.erase(task->key);
    end(std::move(*task), status, forgotten);
    changed_.notify_all();
  }
}

}  // namespace server
