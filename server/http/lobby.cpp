#include "server/http/lobby.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iterator>
#include <optional>
#include <utility>

namespace server {
namespace {

constexpr int kLookForLateMs = 250;
constexpr std::uint64_t kWakeNumber = 0;

enum class Seen { nothing_yet, part, enough, end };

/// What the client has sent, without taking it.
Seen look_at(const Guest& guest, std::vector<char>& buffer) {
  const ssize_t count = ::recv(guest.socket.get(), buffer.data(), buffer.size(), MSG_PEEK | MSG_DONTWAIT);
  if (count == 0) return guest.unread.empty() ? Seen::end : Seen::enough;
  if (count < 0 && errno != EAGAIN && errno != EINTR) return Seen::end;
  const std::string_view fresh(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  if (fresh.size() + guest.unread.size() >= buffer.size()) return Seen::enough;
  if (guest.unread.empty() && is_head_here(fresh)) return Seen::enough;
  if (!guest.unread.empty() && is_head_here(guest.unread + std::string(fresh))) return Seen::enough;
  return fresh.empty() && guest.unread.empty() ? Seen::nothing_yet : Seen::part;
}

/// Has it said all that it ever will?
bool has_hung_up(const epoll_event& event) {
  return (event.events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0;
}

}  // namespace

bool is_head_here(std::string_view text) {
  // Not at the very beginning: an empty line before the request is allowed.
  if (text.find("\r\n\r\n", 1) != text.npos) return true;
  for (std::size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1))
    if (at == 0 || text[at - 1] != '\r') return true;
  return false;
}

void say_in_passing(const Guest& guest, std::string_view text) {
  (void)!::send(guest.socket.get(), text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

api::Status Lobby::start() {
  events_ = FileHandle(::epoll_create1(EPOLL_CLOEXEC));
  wake_ = FileHandle(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!events_ || !wake_) return file_error("watch connections", errno);
  epoll_event wake{EPOLLIN, {.u64 = kWakeNumber}};
  if (::epoll_ctl(events_.get(), EPOLL_CTL_ADD, wake_.get(), &wake) != 0)
    return file_error("watch connections", errno);
  seen_.resize(rules_.head_bytes_max);
  stopped_ = false;
  thread_ = std::thread([this] { run(); });
  return api::Done{};
}

void Lobby::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  if (wake_) (void)::eventfd_write(wake_.get(), 1);
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  waiting_.clear();
}

std::size_t Lobby::guests() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

void Lobby::enter(Guest guest) {
  std::optional<Guest> pushed_out;
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    if (waiting_.size() >= rules_.guests_max) pushed_out = taken_out(waiting_.begin());
    const std::uint64_t number = next_++;
    const int socket = guest.socket.get();
    const bool begun = !guest.unread.empty();
    const auto until = SteadyClock::now() + (begun ? rules_.head : rules_.idle);
    waiting_.emplace(number, Waiting{std::move(guest), until, begun});
    // Told once of whatever comes, also of what is there already.
    epoll_event wanted{EPOLLIN | EPOLLRDHUP | EPOLLET, {.u64 = number}};
    if (::epoll_ctl(events_.get(), EPOLL_CTL_ADD, socket, &wanted) != 0) waiting_.erase(number);
  }
  if (pushed_out) say_in_passing(*pushed_out, rules_.too_many);
}

Guest Lobby::taken_out(std::map<std::uint64_t, Waiting>::iterator place) {
  Guest guest = std::move(place->second.guest);
  waiting_.erase(place);
  (void)::epoll_ctl(events_.get(), EPOLL_CTL_DEL, guest.socket.get(), nullptr);
  return guest;
}

void Lobby::look_after(std::uint64_t number, bool hung_up) {
  std::optional<Guest> guest;
  {
    const std::lock_guard lock(mutex_);
    const auto place = waiting_.find(number);
    if (place == waiting_.end() || stopped_) return;
    const Seen seen = look_at(place->second.guest, seen_);
    if (seen == Seen::part && !std::exchange(place->second.begun, true))
      place->second.until = SteadyClock::now() + rules_.head;
    // A head that was cut off is for somebody to refuse.
    if (!hung_up && (seen == Seen::nothing_yet || seen == Seen::part)) return;
    guest = taken_out(place);
    if (seen == Seen::end || seen == Seen::nothing_yet) return;
  }
  ready_(std::move(*guest));
}

void Lobby::send_away_late() {
  std::vector<Guest> late;
  {
    const std::lock_guard lock(mutex_);
    const auto now = SteadyClock::now();
    for (auto place = waiting_.begin(); place != waiting_.end();) {
      const auto next = std::next(place);
      if (now >= place->second.until) late.push_back(taken_out(place));
      place = next;
    }
  }
  for (Guest& guest : late) {
    const Seen seen = look_at(guest, seen_);
    if (seen == Seen::part) say_in_passing(guest, rules_.too_slow);
    // It was in time, and we are late: many came at once, or this process had no processor for a while.
    if (seen == Seen::enough) ready_(std::move(guest));
    // Who has said nothing expects no answer.
  }
}

void Lobby::run() {
  std::array<epoll_event, 64> events{};
  for (;;) {
    const int count =
        ::epoll_wait(events_.get(), events.data(), static_cast<int>(events.size()), kLookForLateMs);
    for (int i = 0; i < count; ++i) {
      const epoll_event& event = events[static_cast<std::size_t>(i)];
      if (event.data.u64 == kWakeNumber) return;
      look_after(event.data.u64, has_hung_up(event));
    }
    send_away_late();
  }
}

}  // namespace server
