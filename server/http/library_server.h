// cpp-httplib opens the socket, keeps the threads and writes answers. What clients say it does not see: it
// would decode the values of headers ("Transfer-Encoding: %63hunked"), take chunk sizes with a sign, and
// answer ranges and WebSockets by itself. It is handed the method and the path of a request that parse_head
// has let pass. Included by what talks to the library only.
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/http/client_socket.h"
#include "server/http/lobby.h"
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
  std::chrono::milliseconds idle{10'000};   ///< before a request
  std::chrono::milliseconds write{30'000};  ///< without the client taking a byte
  std::chrono::milliseconds part{1'000};    ///< for what is still coming when we close
  std::size_t part_bytes_max = 16 << 20;
  std::size_t requests_max = 1000;
};

/// What a failed accept(2) means.
enum class AcceptTrouble {
  of_one,    ///< one connection, or none: the next may be well
  scarce,    ///< no descriptors or memory now: the connection waits in the kernel
  no_socket  ///< nothing will ever come
};
AcceptTrouble accept_trouble(int error_number);

struct ThreadRules {
  std::size_t threads = 64;
  std::size_t waiting_max = 256;  ///< requests whose head is there, for a thread
};

class LibraryServer : public httplib::Server {
 public:
  ConnectionRules connection_rules;             ///< set before it listens
  std::function<void()> when_answered = [] {};  ///< on the thread that did

  ~LibraryServer() override;

  /// Takes connections until end_listening, and returns when all that was asked is answered. They have a
  /// thread only while a request of theirs is answered. Instead of the library's loop: that one ends, for
  /// good, when the system is out of files or memory for a moment, or reports a client's network error.
  /// False: the socket failed.
  bool listen_and_answer(const ThreadRules& threads, LobbyRules lobby);
  /// From any thread, also before it listens. New connections are refused from now on.
  void end_listening();

  /// The request that this thread answers. Only from the library's handlers.
  static Incoming& incoming();

 private:
  void open(const ThreadRules& threads, LobbyRules lobby);
  bool take_connections();
  void let_in(int socket);
  void close();
  void hand_on(Guest guest);
  void serve(Guest guest);
  void answer_all(ClientSocket& client, Guest& guest);
  bool answer(ClientSocket& client, const std::string& address, bool last);

  std::unique_ptr<Lobby> lobby_;
  std::unique_ptr<httplib::ThreadPool> threads_;
  std::string too_many_;
  std::atomic<std::size_t> waiting_ = 0;  ///< for a thread
  std::atomic<bool> closing_ = false;
  std::atomic<int> ended_socket_ = INVALID_SOCKET;  ///< that nobody listens to any more
};

}  // namespace server
