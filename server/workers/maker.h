// What is made on request and kept: views and videos. A few at a time, the others wait in line.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "api/result.h"

namespace server {

/// Safe for use by several threads.
class Maker {
 public:
  /// Ends soon with Fault::stopped when `stopping` turns true. Called by a thread that lives as long as the
  /// Maker: it may start processes. Where it ends with Fault::disk_full it is called again later.
  using Work = std::function<api::Status(const std::atomic<bool>& stopping)>;

  enum class State { unknown, waiting, making, failed };
  struct Look {
    State state = State::unknown;
    api::Error error = {};  ///< of `failed`; of `waiting`, where it has been tried and waits for room
  };

  /// `room_after`: what found the disk full is tried again so much later.
  Maker(std::size_t at_once, std::size_t waiting_max,
        std::chrono::milliseconds room_after = std::chrono::seconds(5));
  ~Maker() { stop(); }
  Maker(const Maker&) = delete;
  Maker& operator=(const Maker&) = delete;

  /// Has `work` done under the name `key`; nothing new where that is waited for or being made already. One
  /// that has failed is tried again. Error: out_of_resources where too many wait.
  api::Status ask(const std::string& key, Work work);
  /// Unknown: never asked for, or done.
  Look look(const std::string& key) const;
  /// Forgets what waits or has failed. False: it is being made.
  bool forget(const std::string& key);
  /// Forgets all whose key begins with `prefix`; what is being made of it is stopped. Returns when that has
  /// ended, which takes as long as its work does to notice.
  void end_all(const std::string& prefix);
  /// Ends what is being made, forgets what waits. Returns when the threads have ended.
  void stop();

 private:
  static constexpr std::size_t kFailuresMax = 1000;

  using SteadyClock = std::chrono::steady_clock;

  struct Task {
    std::string key;
    Work work;
    SteadyClock::time_point not_before = {};
  };

  void run();
  std::optional<Task> next(std::unique_lock<std::mutex>& lock);  ///< none: the Maker is stopping
  void end(Task task, const api::Status& status, bool forgotten);

  const std::size_t waiting_max_;
  const std::chrono::milliseconds room_after_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> waiting_;
  std::map<std::string, std::atomic<bool>> made_;  ///< what is being made, and whether it is to stop
  std::map<std::string, Look> looks_;
  std::deque<std::string> failures_;  ///< the oldest first
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace server
