// Where connections wait until their client has said what it wants. One thread watches all of them, so that
// those who say it slowly, or never, hold none of the threads that answer.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// A connection. Closed with this object.
struct Guest {
  FileHandle socket;
  std::string address = {};       ///< of the client
  std::size_t requests_left = 1;  ///< that it may still make
  std::string unread = {};        ///< what came behind its last request
};

struct LobbyRules {
  std::size_t guests_max = 400;            ///< beyond it the one that has been there longest goes
  std::chrono::milliseconds idle{10'000};  ///< before the first byte of a request
  /// From there to the whole head. Counted for all of it: a byte now and then does not help.
  std::chrono::milliseconds head{10'000};
  std::size_t head_bytes_max = 64 << 10;  ///< longer ones are handed on, for somebody to refuse
  std::string too_slow = {};              ///< the answer to a head that was begun but not ended in time
  std::string too_many = {};              ///< the answer to who has to go
};

/// Does `text` hold the head of a request, or a line that ends wrongly, so that no more needs to be waited
/// for?
bool is_head_here(std::string_view text);

/// Says what the client takes at once of `text`, and does not wait.
void say_in_passing(const Guest& guest, std::string_view text);

/// Safe for use by several threads.
class Lobby {
 public:
  /// `ready` hears of every guest whose request's head is there, is too long, or was cut off: whoever reads
  /// it will not have to wait. On the lobby's thread: it must be quick.
  using Ready = std::function<void(Guest)>;

  Lobby(LobbyRules rules, Ready ready) : rules_(std::move(rules)), ready_(std::move(ready)) {}
  ~Lobby() { stop(); }
  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;

  api::Status start();
  /// Sends everybody away, also those who come later.
  void stop();

  void enter(Guest guest);
  std::size_t guests() const;

 private:
  using SteadyClock = std::chrono::steady_clock;
  struct Waiting {
    Guest guest;
    SteadyClock::time_point until;
    bool begun = false;  ///< a part of its head is there
  };

  void run();
  void look_after(std::uint64_t number, bool hung_up);
  void send_away_late();
  Guest taken_out(std::map<std::uint64_t, Waiting>::iterator place);

  const LobbyRules rules_;
  const Ready ready_;
  FileHandle events_;  ///< epoll
  FileHandle wake_;    ///< eventfd
  std::thread thread_;
  std::vector<char> seen_;  ///< of the lobby's thread

  mutable std::mutex mutex_;  ///< of what follows
  bool stopped_ = true;
  std::uint64_t next_ = 1;
  std::map<std::uint64_t, Waiting> waiting_;  ///< by the order in which they came
};

}  // namespace server
