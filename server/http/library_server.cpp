#include "server/http/library_server.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <utility>

#include "server/log.h"

namespace server {
namespace {

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

bool LibraryServer::process_and_close_socket(socket_t socket) {
  ClientSocket client(socket);
  // One client's misfortune, such as no memory for what it asked for, is not everybody's.
  try {
    std::string address;
    int port = 0;
    httplib::detail::get_remote_ip_and_port(socket, address, port);
    const auto stopped = [this] { return svr_sock_ == INVALID_SOCKET; };
    for (std::size_t left = connection_rules.requests_max; left > 0; --left)
      if (!client.wait(connection_rules.idle, stopped) || !answer(client, address, left == 1)) break;
    return true;
  } catch (const std::exception& error) {
    log_line(std::string("a connection was given up: ") + error.what());
  } catch (...) {
    log_line("a connection was given up");
  }
  current_incoming = nullptr;
  when_answered();
  return false;
}

}  // namespace server
