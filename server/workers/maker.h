// What is made on request and kept: views and videos. A few at a time, the others wait in line.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
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
  /// Maker: it may start processes.
  using Work = std::function<api::Status(const std::atomic<bool>& stopping)>;

  enum class State { unknown, waiting, making, failed };
  struct Look {
    State state = State::unknown;
    api::Error error = {};  ///< of `failed`
  };

  Maker(std::size_t at_once, std::size_t waiting_max);
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
  /// Ends what is being made, forgets what waits. Returns when the threads have ended.
  void stop();

 private:
  static constexpr std::size_t kFailuresMax = 1000;

  void run();
  void end(const std::string& key, const api::Status& status);

  const std::size_t waiting_max_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::pair<std::string, Work>> waiting_;
  std::map<std::string, Look> looks_;
  std::deque<std::string> failures_;  ///< the oldest first
  std::atomic<bool> stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace server
