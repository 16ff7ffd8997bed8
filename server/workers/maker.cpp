#include "server/workers/maker.h"

#include <algorithm>
#include <utility>

#include "server/log.h"

namespace server {

Maker::Maker(std::size_t at_once, std::size_t waiting_max) : waiting_max_(waiting_max) {
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
    waiting_.emplace_back(key, std::move(work));
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
  std::erase_if(waiting_, [&](const auto& entry) { return entry.first == key; });
  std::erase(failures_, key);
  looks_.erase(found);
  return true;
}

void Maker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

void Maker::end(const std::string& key, const api::Status& status) {
  const std::lock_guard lock(mutex_);
  if (status || status.error().fault == api::Fault::stopped) {
    looks_.erase(key);
    return;
  }
  log_line(key + ": " + status.error().message);
  looks_[key] = {State::failed, status.error()};
  failures_.push_back(key);
  if (failures_.size() <= kFailuresMax) return;
  looks_.erase(failures_.front());
  failures_.pop_front();
}

void Maker::run() {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    if (stopping_) return;
    const auto [key, work] = std::move(waiting_.front());
    waiting_.pop_front();
    looks_[key].state = State::making;
    lock.unlock();
    end(key, work(stopping_));
  }
}

}  // namespace server
