// cpp-httplib listens, keeps the threads and writes answers. What clients say it does not see: it would
// decode the values of headers ("Transfer-Encoding: %63hunked"), take chunk sizes with a sign, and answer
// ranges and WebSockets by itself. It is handed the method and the path of a request that parse_head has let
// pass. Included by what talks to the library only.
#pragma once

#include <httplib.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "server/http/client_socket.h"
#include "server/http/request_head.h"

namespace server {

/// A request as it came over the socket. It lives until it is answered.
struct Incoming {
  ClientSocket& client;
  const ParsedHead& parsed;
  std::string address;           ///< of the client
  bool close_after = false;      ///< set before the answer goes out: this request is the connection's last
  bool has_unread_body = false;  ///< likewise: the client may still be sending
};

struct ConnectionRules {
  std::chrono::milliseconds head{10'000};   ///< for all of a request's head
  std::chrono::milliseconds idle{2'000};    ///< before a request: the connection holds a thread
  std::chrono::milliseconds write{30'000};  ///< without the client taking a byte
  std::chrono::milliseconds part{1'000};    ///< for what is still coming when we close
  std::size_t part_bytes_max = 16 << 20;
  std::size_t requests_max = 1000;
};

class LibraryServer : public httplib::Server {
 public:
  ConnectionRules connection_rules;             ///< set before it listens
  std::function<void()> when_answered = [] {};  ///< on the thread that did

  /// The request that this thread answers. Only from the library's handlers.
  static Incoming& incoming();

 private:
  bool process_and_close_socket(socket_t socket) override;
  bool answer(ClientSocket& client, const std::string& address, bool last);
};

}  // namespace server
