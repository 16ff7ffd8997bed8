// One thread that looks at the database for those who wait for news of jobs.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "api/result.h"
#include "server/store/event_reader.h"

namespace server {

struct EventRules {
  std::chrono::milliseconds look_every{100};      ///< news is at most this old
  std::size_t listeners_max = 32;                 ///< each holds a thread of the HTTP server
  std::chrono::milliseconds ask_again{500};       ///< whether a listener may still listen
  std::chrono::milliseconds stream_max{600'000};  ///< then it comes back, and goes on from where it was
};

/// Writers need not know of listeners: whether there is news is asked of the database itself.
class EventHub {
 public:
  /// `reader` must outlive it.
  EventHub(EventReader& reader, EventRules rules = {});
  ~EventHub() { stop(); }
  EventHub(const EventHub&) = delete;
  EventHub& operator=(const EventHub&) = delete;

  /// `tell`, if given, hears of every event from now on, once and in order, on the hub's thread.
  api::Status start(std::function<void(const JobEvent&)> tell = {});
  /// Wakes all that wait, who learn of it by stopped().
  void stop();
  bool stopped() const { return stopped_; }

  /// A place among the listeners, for as long as it is held; none: all are taken.
  std::shared_ptr<void> take_place();
  std::size_t listeners() const { return listeners_; }

  /// Waits until there is other news than `seen`, or until `patience` is over or the hub stops. -> what to
  /// pass as `seen` next
  std::uint64_t wait(std::uint64_t seen, std::chrono::milliseconds patience);

  /// All jobs that were being worked at when the hub last looked.
  std::vector<JobProgress> progress();
  EventReader& reader() { return reader_; }
  const EventRules& rules() const { return rules_; }

 private:
  void run();
  bool look();  ///< false: not all could be read

  EventReader& reader_;
  const EventRules rules_;
  std::function<void(const JobEvent&)> tell_;
  std::int64_t told_ = 0;  ///< id of the last event that `tell_` has heard of
  std::mutex mutex_;
  std::condition_variable news_;
  std::uint64_t generation_ = 1;
  std::vector<JobProgress> progress_;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::size_t> listeners_ = 0;
  std::thread thread_;
};

}  // namespace server
