#include "server/http/library_server.h"

#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <thread>
#include <utility>

#include "server/log.h"

namespace server {
namespace {

constexpr std::chrono::milliseconds kStay{50};
constexpr std::chrono::milliseconds kScarcePause{20};

thread_local Incoming* current_incoming = nullptr;

/// %2F is a character of a name. Decoded like the others it would part names, and lead past a proxy that has
/// other rules for /v1 than for /v1%2Fjobs.
std::string with_slashes_kept(const std::string& target) {
  std::string kept;
  const std::size_t query = std::min(target.find('?'), target.size());
  for (std::size_t i = 0; i < target.size(); ++i) {
    const bool is_slash = i + 2 < query && target[i] == '%' && target[i + 1] == '2' &&
                          (target[i + 2] == 'f' || target[i + 2] == 'F');
    kept += target[i];
    if (is_slash) kept += "25";
  }
  return kept;
}

std::string head_for_library(const ParsedHead& parsed) {
  const RequestHead& head = parsed.head;
  // A refused one may be of any kind; it only has to come to our handler.
  if (parsed.refused) return "GET / HTTP/1.1\r\n\r\n";
  return head.method + " " + with_slashes_kept(head.target) + " HTTP/1.1\r\n\r\n";
}

/// Reads what the library is to see, writes to the client.
class LibraryStream : public httplib::Stream {
 public:
  LibraryStream(ClientSocket& client, std::string address, std::string head,
                std::chrono::milliseconds write_patience)
      : client_(client),
        address_(std::move(address)),
        head_(std::move(head)),
        write_patience_(write_patience) {}

  bool is_readable() const override { return at_ < head_.size(); }
  bool wait_readable() const override { return is_readable(); }
  bool wait_writable() const override { return client_.can_write(write_patience_); }
  bool is_peer_alive() const override { return client_.is_open(); }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min(size, head_.size() - at_);
    std::memcpy(to, head_.data() + at_, count);
    at_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, std::size_t size) override {
    return client_.write(from, size, write_patience_);
  }
  void get_remote_ip_and_port(std::string& ip, int&) const override { ip = address_; }
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return client_.get(); }
  time_t duration() const override { return 0; }

 private:
  ClientSocket& client_;
  const std::string address_;
  const std::string head_;
  const std::chrono::milliseconds write_patience_;
  std::size_t at_ = 0;
};

ParsedHead refusal(int status, const char* detail) {
  return {{}, HeadRefusal{status, detail}};
}

}  // namespace

Incoming& LibraryServer::incoming() {
  return *current_incoming;
}

/// -> may another request follow?
bool LibraryServer::answer(ClientSocket& client, const std::string& address, bool last) {
  using Head = ClientSocket::Head;
  std::string text;
  const Head got = client.read_head(text, kHeadBytesMax, connection_rules.head,
                                    [this] { return svr_sock_ == INVALID_SOCKET; });
  if (got == Head::closed) return false;
  const ParsedHead parsed = got == Head::too_slow   ? refusal(408, "the request's head came in too slowly")
                            : got == Head::too_long ? refusal(431, "the request's head is too long")
                                                    : parse_head(text);
  Incoming incoming{client, parsed, address, last || parsed.refused || parsed.head.closes,
                    parsed.refused.has_value()};
  current_incoming = &incoming;
  LibraryStream stream(client, address, head_for_library(parsed), connection_rules.write);
  bool connection_closed = false;
  const bool written =
      process_request(stream, address, 0, std::string(), 0, incoming.close_after, connection_closed, nullptr);
  current_incoming = nullptr;
  when_answered();
  if (written && incoming.has_unread_body)
    client.part_with(connection_rules.part, connection_rules.part_bytes_max);
  return written && !connection_closed && !incoming.close_after;
}

AcceptTrouble accept_trouble(int error_number) {
  switch (error_number) {
    case EBADF:
    case EFAULT:
    case EINVAL:
    case ENOTSOCK:
      return AcceptTrouble::no_socket;
    case EMFILE:
    case ENFILE:
    case ENOBUFS:
    case ENOMEM:
      return AcceptTrouble::scarce;
    default:
      // Gone before it was let in, or an error of the network that Linux hands on as accept's own.
      return AcceptTrouble::of_one;
  }
}

LibraryServer::~LibraryServer() {
  for (const int socket : {svr_sock_.load(), ended_socket_.load()})
    if (socket != INVALID_SOCKET) ::close(socket);
}

bool LibraryServer::listen_and_answer(const ThreadRules& threads, LobbyRules lobby) {
  open(threads, std::move(lobby));
  const bool well = take_connections();
  close();
  return well;
}

bool LibraryServer::take_connections() {
  bool told = false;
  const int listening = svr_sock_;
  while (svr_sock_ != INVALID_SOCKET) {
    const int socket = ::accept4(listening, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket >= 0) {
      let_in(socket);
      told = false;
      continue;
    }
    const AcceptTrouble trouble = accept_trouble(errno);
    if (svr_sock_ == INVALID_SOCKET) break;
    if (trouble == AcceptTrouble::no_socket ||
        (trouble == AcceptTrouble::scarce && !std::exchange(told, true)))
      log_line("connections cannot be taken: " + std::string(std::strerror(errno)));
    if (trouble == AcceptTrouble::no_socket) return false;
    if (trouble == AcceptTrouble::scarce) std::this_thread::sleep_for(kScarcePause);
  }
  return true;
}

// The descriptor stays: closed, its number might be another file's before the thread that accepts has
// noticed.
void LibraryServer::end_listening() {
  const int socket = svr_sock_.exchange(INVALID_SOCKET);
  if (socket == INVALID_SOCKET) return;
  ended_socket_ = socket;
  ::shutdown(socket, SHUT_RDWR);
}

void LibraryServer::let_in(int socket) {
  const int yes = 1;  // otherwise every answer waits for the client's delayed acknowledgement
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  std::string address;
  int port = 0;
  httplib::detail::get_remote_ip_and_port(socket, address, port);
  lobby_->enter({FileHandle(socket), std::move(address), connection_rules.requests_max, {}});
}

void LibraryServer::open(const ThreadRules& threads, LobbyRules lobby) {
  too_many_ = lobby.too_many;
  threads_ = std::make_unique<httplib::ThreadPool>(threads.threads, threads.threads, threads.waiting_max);
  lobby_ = std::make_unique<Lobby>(std::move(lobby), [this](Guest guest) { hand_on(std::move(guest)); });
  if (const api::Status started = lobby_->start(); !started) log_line(started.error().message);
}

void LibraryServer::close() {
  closing_ = true;
  lobby_->stop();
  threads_->shutdown();
}

void LibraryServer::hand_on(Guest guest) {
  const auto held = std::make_shared<Guest>(std::move(guest));
  ++waiting_;
  if (threads_->enqueue([this, held] {
        --waiting_;
        serve(std::move(*held));
      }))
    return;
  --waiting_;
  say_in_passing(*held, too_many_);
}

// One client's misfortune, such as no memory for what it asked for, is not everybody's.
void LibraryServer::serve(Guest guest) {
  ClientSocket client(guest.socket.release(), guest.unread);
  try {
    return answer_all(client, guest);
  } catch (const std::exception& error) {
    log_line(std::string("a connection was given up: ") + error.what());
  } catch (...) {
    log_line("a connection was given up");
  }
  current_incoming = nullptr;
  when_answered();
}

void LibraryServer::answer_all(ClientSocket& client, Guest& guest) {
  const auto stopped = [this] { return closing_.load(); };
  do {
    if (guest.requests_left == 0 || !answer(client, guest.address, guest.requests_left == 1)) return;
    --guest.requests_left;
    // Busy clients say at once what they want next, and a thread that stays costs nobody anything as long as
    // nobody waits for one.
    (void)client.wait(waiting_ > 0 ? std::chrono::milliseconds(0) : kStay, stopped);
  } while (client.has_head() && !closing_);
  guest.socket = FileHandle(client.release(guest.unread));
  lobby_->enter(std::move(guest));
}

}  // namespace server
