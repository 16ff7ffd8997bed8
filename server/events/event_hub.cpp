#include "server/events/event_hub.h"

#include <utility>

#include "server/log.h"

namespace server {
namespace {

constexpr std::int64_t kPageEvents = 500;

}  // namespace

EventHub::EventHub(EventReader& reader, EventRules rules) : reader_(reader), rules_(rules) {}

api::Status EventHub::start(std::function<void(const JobEvent&)> tell) {
  const auto newest = reader_.newest();
  if (!newest) return newest.error();
  told_ = *newest;
  tell_ = std::move(tell);
  thread_ = std::thread([this] { run(); });
  return api::Done{};
}

void EventHub::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  news_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<void> EventHub::take_place() {
  if (++listeners_ > rules_.listeners_max) {
    --listeners_;
    return nullptr;
  }
  return {static_cast<void*>(this), [](void* hub) { --static_cast<EventHub*>(hub)->listeners_; }};
}

std::uint64_t EventHub::wait(std::uint64_t seen, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, patience, [&] { return stopped_ || generation_ != seen; });
  return generation_;
}

std::vector<JobProgress> EventHub::progress() {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void EventHub::run() {
  bool up_to_date = look();
  std::unique_lock lock(mutex_);
  while (!news_.wait_for(lock, rules_.look_every, [this] { return stopped_.load(); })) {
    lock.unlock();
    const auto changed = reader_.changed();
    // What cannot be read now is read later; listeners notice nothing but the delay.
    if (!up_to_date || !changed || *changed) up_to_date = look();
    lock.lock();
  }
}

bool EventHub::look() {
  bool whole = !tell_;
  while (!whole) {
    const auto events = reader_.after(told_, std::nullopt, kPageEvents);
    if (!events) {
      log_line("events cannot be read: " + events.error().message);
      return false;
    }
    for (const JobEvent& event : *events) {
      tell_(event);
      told_ = event.id;
    }
    whole = static_cast<std::int64_t>(events->size()) < kPageEvents;
  }
  auto progress = reader_.progress();
  if (!progress) return false;
  {
    const std::lock_guard lock(mutex_);
    progress_ = std::move(*progress);
    ++generation_;
  }
  news_.notify_all();
  return true;
}

}  // namespace server
