#include "server/http/client_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "server/http/lobby.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kLookUp{100};  // how long a stop may stay unnoticed

bool poll_for(int socket, short events, milliseconds patience) {
  pollfd asked{socket, events, 0};
  int count = 0;
  do count = ::poll(&asked, 1, static_cast<int>(patience.count()));
  while (count < 0 && errno == EINTR);
  return count > 0;
}

milliseconds until(SteadyClock::time_point end) {
  return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(end - SteadyClock::now()));
}

}  // namespace

ClientSocket::ClientSocket(int socket, std::string_view unread)
    : socket_(socket), end_(std::min(unread.size(), buffer_.size())) {
  std::memcpy(buffer_.data(), unread.data(), end_);
}

ClientSocket::~ClientSocket() {
  if (socket_ < 0) return;
  ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

int ClientSocket::release(std::string& unread) {
  unread.assign(buffer_.data() + at_, end_ - at_);
  return std::exchange(socket_, -1);
}

bool ClientSocket::has_head() const {
  std::string text(buffer_.data() + at_, end_ - at_);
  std::array<char, 4096> piece;
  const ssize_t count = ::recv(socket_, piece.data(), piece.size(), MSG_PEEK | MSG_DONTWAIT);
  if (count > 0) text.append(piece.data(), static_cast<std::size_t>(count));
  return is_head_here(text);
}

bool ClientSocket::wait(milliseconds patience, const GiveUp& give_up) {
  if (has_bytes()) return true;
  const auto end = SteadyClock::now() + patience;
  for (;;) {
    const milliseconds left = until(end);
    if (poll_for(socket_, POLLIN, std::min(left, kLookUp))) return true;
    if (left <= kLookUp || give_up()) return false;
  }
}

ssize_t ClientSocket::fill(milliseconds patience, const GiveUp& give_up) {
  if (!wait(patience, give_up)) return -1;
  const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
  at_ = 0;
  end_ = count > 0 ? static_cast<std::size_t>(count) : 0;
  return count;
}

ClientSocket::Head ClientSocket::read_head(std::string& to, std::size_t bytes_max, milliseconds patience,
                                           const GiveUp& give_up) {
  const auto end = SteadyClock::now() + patience;
  std::size_t line_begin = 0;
  for (;;) {
    while (has_bytes()) {
      const char byte = buffer_[at_++];
      to += byte;
      if (to.size() > bytes_max) return Head::too_long;
      if (byte != '\n') continue;
      const std::string_view line = std::string_view(to).substr(line_begin);
      // An empty line before the first is skipped; a line that ends wrongly is for parse_head to refuse.
      if (!line.ends_with("\r\n") || (line.size() == 2 && line_begin > 2)) return Head::whole;
      line_begin = to.size();
    }
    if (SteadyClock::now() >= end) return Head::too_slow;
    if (const ssize_t count = fill(until(end), give_up); count <= 0)
      return count < 0 && !give_up() ? Head::too_slow : Head::closed;
  }
}

ssize_t ClientSocket::read(char* to, std::size_t size, milliseconds patience, const GiveUp& give_up) {
  if (!has_bytes() && size >= buffer_.size())
    return wait(patience, give_up) ? ::recv(socket_, to, size, MSG_DONTWAIT) : -1;
  if (!has_bytes())
    if (const ssize_t count = fill(patience, give_up); count <= 0) return count;
  const std::size_t count = std::min(size, end_ - at_);
  std::memcpy(to, buffer_.data() + at_, count);
  at_ += count;
  return static_cast<ssize_t>(count);
}

bool ClientSocket::can_write(milliseconds patience) const {
  return poll_for(socket_, POLLOUT, patience);
}

ssize_t ClientSocket::write(const char* from, std::size_t size, milliseconds patience) {
  // Mostly there is room, and no need to ask for it.
  for (bool waited = false;; waited = true) {
    const ssize_t count = ::send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0 || waited || (errno != EAGAIN && errno != EINTR)) return count;
    if (!can_write(patience)) return -1;
  }
}

bool ClientSocket::is_open() const {
  if (!poll_for(socket_, POLLIN, milliseconds(0))) return true;
  char byte = 0;
  const ssize_t count = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count > 0 || (count < 0 && errno == EAGAIN);
}

void ClientSocket::part_with(milliseconds patience, std::size_t bytes_max) {
  ::shutdown(socket_, SHUT_WR);
  const auto end = SteadyClock::now() + patience;
  for (std::size_t dropped = 0; dropped < bytes_max;) {
    const milliseconds left = until(end);
    if (left.count() == 0 || !poll_for(socket_, POLLIN, left)) return;
    const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count <= 0) return;
    dropped += static_cast<std::size_t>(count);
  }
}

}  // namespace server
