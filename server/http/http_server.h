// The listening socket.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "api/result.h"
#include "server/http/gate.h"
#include "server/http/router.h"

namespace server {

struct HttpRules {
  std::string host = "127.0.0.1";
  int port = 8080;                                        ///< 0: any free one
  std::int64_t upload_bytes_max = std::int64_t{2} << 30;  ///< of one body that streams
  std::size_t small_body_bytes_max = 1 << 20;             ///< of one that does not
  // A connection holds a thread while a request of its is answered. All threads are there from the start,
  // because the library's pool does not grow in a burst. Uploads, listeners and those who wait for a job to
  // end have limits of their own, which leave many of them free.
  std::size_t threads = 128;
  std::size_t connections_waiting_max = 128;  ///< for a thread; further ones are 503
  std::size_t connections_idle_max = 400;     ///< without a request; beyond it the oldest goes
  std::size_t uploads_max = 32;  ///< at once, further ones are 503: the other threads stay free for reading
  std::chrono::milliseconds head_patience{
      10'000};                                     ///< for a request's head, from its first byte on; then 408
  std::chrono::milliseconds body_silence{10'000};  ///< a body that says nothing for so long is given up
  std::chrono::milliseconds upload_grace{10'000};  ///< from here on a body slower than this is 408:
  std::int64_t upload_bytes_per_s = 1024;
};

/// A request and its answer, as they are counted and logged: once the answer begins.
struct Exchange {
  std::string request_id;
  std::string method;
  std::string path;   ///< as it came, decoded: a stranger's words
  std::string route;  ///< "GET /v1/jobs/{id}"; empty where there is none
  std::string owner;
  std::string address;
  int status = 0;
  double seconds = 0;
};

class HttpServer {
 public:
  /// `router` and `gate` must outlive it. `tell` hears of every exchange, on the thread that answers it.
  HttpServer(const Router& router, Gate& gate, HttpRules rules,
             std::function<void(const Exchange&)> tell = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Takes the port. Errors: wrong_state where it is taken or not ours to take.
  api::Status bind();
  int port() const;
  std::size_t uploads() const;  ///< under way
  /// Answers requests until `stop`. False: the socket failed.
  bool run();
  /// Any other thread than `run`'s. Takes no new connections and waits up to
  /// `patience` for requests that are being answered. Files on their way out are cut short: who fetches one
  /// comes back for the rest.
  void drain(std::chrono::milliseconds patience);
  /// Likewise, but at once: uploads are cut short too.
  void stop();

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace server
