// A request's body as it comes in: counted, and not waited for without end.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "server/http/client_socket.h"
#include "server/http/message.h"
#include "server/http/request_head.h"

namespace server {

struct BodyPatience {
  std::chrono::milliseconds silence{10'000};  ///< without a byte
  /// A body slower than `bytes_per_s`, counted from its begin, is given up after `grace`.
  std::chrono::milliseconds grace{10'000};
  std::int64_t bytes_per_s = 1024;
};

/// What it is given must outlive it.
class BodyReader {
 public:
  BodyReader(ClientSocket& client, const RequestHead& head, const std::atomic<bool>& stopping)
      : client_(client), head_(head), stopping_(stopping) {}

  /// Of at most `bytes_max` bytes. Who waits to be told to go on is told when the first piece is asked for.
  ReadBody reading(std::int64_t bytes_max, BodyPatience patience);

  /// Nothing of it is left to come: it was read to its end, or there is none.
  bool is_over() const { return over_ || head_.body == BodyKind::none; }
  bool too_slow() const { return too_slow_; }
  bool too_large() const { return too_large_; }

 private:
  using SteadyClock = std::chrono::steady_clock;
  using Take = std::function<bool(std::string_view)>;

  bool read(const Take& take);
  bool read_counted(const Take& take);
  bool read_chunks(const Take& take);
  bool read_bytes(std::int64_t count, const Take& take);
  bool read_line(std::string& line);
  bool is_too_slow();
  ssize_t receive(char* to, std::size_t size);

  ClientSocket& client_;
  const RequestHead& head_;
  const std::atomic<bool>& stopping_;
  BodyPatience patience_;
  SteadyClock::time_point begun_;
  std::int64_t bytes_ = 0;
  std::int64_t bytes_max_ = 0;
  bool over_ = false;
  bool too_slow_ = false;
  bool too_large_ = false;
};

enum class SmallBody { whole, too_large, cut_off };

/// All of a body of at most `bytes_max` bytes into `to`.
SmallBody read_small_body(const ReadBody& read_body, std::size_t bytes_max, std::string& to);

}  // namespace server
