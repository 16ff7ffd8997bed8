// A client's connection: bytes in and out, none of them waited for without end.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace server {

/// Owns the socket; the destructor closes it.
class ClientSocket {
 public:
  using Milliseconds = std::chrono::milliseconds;
  /// Asked several times a second while we wait; true: wait no longer.
  using GiveUp = std::function<bool()>;

  explicit ClientSocket(int socket) : socket_(socket) {}
  /// `unread`: bytes that were read already.
  ClientSocket(int socket, std::string_view unread);
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  int get() const { return socket_; }
  /// Gives the connection up: the caller owns the socket now, and has to know what was read of it.
  int release(std::string& unread);

  /// Is the head of a request there, so that nobody waits who reads it?
  bool has_head() const;

  /// Is there anything to read within `patience`: bytes, or the end?
  bool wait(Milliseconds patience, const GiveUp& give_up);

  enum class Head { whole, closed, too_slow, too_long };
  /// Appends what comes up to and with the first empty line, or up to where a line ends wrongly. `patience`
  /// is for all of it.
  Head read_head(std::string& to, std::size_t bytes_max, Milliseconds patience, const GiveUp& give_up);

  /// Up to `size` bytes as soon as there are any; 0: the client has said all; less: it fell silent for as
  /// long as `patience`, was given up, or is gone.
  ssize_t read(char* to, std::size_t size, Milliseconds patience, const GiveUp& give_up);

  /// Up to `size` bytes of `from` as soon as the client takes any; less than 0: it takes none.
  ssize_t write(const char* from, std::size_t size, Milliseconds patience);
  bool can_write(Milliseconds patience) const;
  /// Not, once the client has closed its side.
  bool is_open() const;

  /// Says that nothing more comes from us, and throws away what the client is still sending, so that it can
  /// read the answer: a connection closed with bytes unread is reset.
  void part_with(Milliseconds patience, std::size_t bytes_max);

 private:
  bool has_bytes() const { return at_ < end_; }
  ssize_t fill(Milliseconds patience, const GiveUp& give_up);

  int socket_;
  std::array<char, 16 * 1024> buffer_;  ///< what came behind what was asked for
  std::size_t at_ = 0, end_ = 0;
};

}  // namespace server
