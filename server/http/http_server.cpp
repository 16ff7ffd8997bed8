#include "server/http/http_server.h"

#include <httplib.h>

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "server/http/body_reader.h"
#include "server/http/library_answer.h"
#include "server/http/library_request.h"
#include "server/http/library_server.h"
#include "server/http/problem.h"
#include "server/log.h"

namespace server {
namespace {

constexpr std::int64_t kMultipartFrameBytes = 1 << 20;
constexpr std::size_t kRequestIdBytesMax = 64;

/// The request that this thread is answering: a thread has one at a time.
thread_local HttpRequest current;
thread_local std::string current_route;
thread_local std::string current_id;
thread_local std::optional<std::chrono::steady_clock::time_point> begun_at;  ///< none: we never saw it
thread_local std::vector<std::pair<std::string, std::string>> more_headers;  ///< for its answer

bool is_request_id(std::string_view text) {
  return !text.empty() && text.size() <= kRequestIdBytesMax &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
                  c == '_' || c == '-';
         });
}

std::string new_request_id() {
  std::array<unsigned char, 8> bytes{};
  (void)!::getrandom(bytes.data(), bytes.size(), 0);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string id;
  for (const unsigned char byte : bytes) {
    id += kDigits[byte >> 4];
    id += kDigits[byte & 15];
  }
  return id;
}

/// The client's, so that its log and ours can be matched, or a new one.
std::string id_of(const RequestHead& head) {
  const std::string given = head.field("X-Request-Id").value_or("");
  return is_request_id(given) ? given : new_request_id();
}

/// Answers are data: no browser is to guess their type, run them, or show them inside another page.
void set_safe_headers(httplib::Response& response) {
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Referrer-Policy", "no-referrer");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  if (!response.has_header("Content-Security-Policy"))
    response.set_header("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
}

/// An answer as it goes over the wire where no thread is at hand to give it.
std::string last_words(const HttpAnswer& answer) {
  std::string text = "HTTP/1.1 " + std::to_string(answer.status) + " " +
                     std::string(title_of(answer.status)) + "\r\nContent-Type: " + answer.content_type +
                     "\r\nContent-Length: " + std::to_string(answer.body.size()) +
                     "\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n";
  for (const auto& [name, value] : answer.headers) text += name + ": " + value + "\r\n";
  return text + "\r\n" + answer.body;
}

/// One of a number of places, for as long as it lives.
class Place {
 public:
  Place(std::atomic<std::size_t>& taken, std::size_t most) : taken_(taken), ours_(++taken <= most) {}
  ~Place() { --taken_; }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  explicit operator bool() const { return ours_; }

 private:
  std::atomic<std::size_t>& taken_;
  const bool ours_;
};

}  // namespace

struct HttpServer::Library {
  Library(const Router& router_, Gate& gate_, HttpRules rules_, std::function<void(const Exchange&)> tell_)
      : router(router_), gate(gate_), rules(std::move(rules_)), tell(std::move(tell_)) {
    set_limits();
    set_handlers();
  }

  void set_limits() {
    // The library's default shares the port with whoever else asks for it.
    server.set_socket_options([](auto socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    const ConnectionRules& connections = server.connection_rules;
    server.set_keep_alive_max_count(connections.requests_max);  // these two are only said to clients
    server.set_keep_alive_timeout(std::chrono::duration_cast<std::chrono::seconds>(connections.idle).count());
    server.connection_rules.head = rules.head_patience;
  }

  LobbyRules lobby_rules() const {
    LobbyRules lobby;
    lobby.guests_max = rules.connections_idle_max;
    lobby.idle = server.connection_rules.idle;
    lobby.head = rules.head_patience;
    lobby.head_bytes_max = kHeadBytesMax;
    lobby.too_slow = last_words(problem(408, "the request's head came in too slowly", ""));
    lobby.too_many = last_words(problem(503, "too many connections at once", ""));
    return lobby;
  }

  void set_handlers() {
    using Handled = httplib::Server::HandlerResponse;
    server.set_pre_routing_handler([this](const auto& request, auto& response) {
      Incoming& incoming = LibraryServer::incoming();
      begin(request, incoming);
      send(answer_to(incoming), stopping, response);
      return Handled::Handled;
    });
    server.set_error_handler([this](const auto& request, auto& response) {
      // Only for what the library refuses by itself: ours have a body.
      if (!response.body.empty() || response.content_provider_) return;
      send(problem(response.status, title_of(response.status), request.path), stopping, response);
    });
    server.set_exception_handler([this](const auto& request, auto& response, std::exception_ptr thrown) {
      send(answer_to_exception(request.path, thrown), stopping, response);
    });
    server.set_post_routing_handler([this](const auto& request, auto& response) {
      Incoming& incoming = LibraryServer::incoming();
      const std::string id = begun_at ? current_id : id_of(incoming.parsed.head);
      response.set_header("X-Request-Id", id);
      for (const auto& [name, value] : std::exchange(more_headers, {})) response.set_header(name, value);
      set_safe_headers(response);
      if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
      say_if_last(incoming, response);
      if (tell) tell(exchange_of(id, request, response.status));
      end_answering();
    });
    server.when_answered = [this] {
      end_answering();
      // A body of a megabyte, and what refers to a request that is no more. Moved out: a string to which an
      // empty one is assigned keeps its memory.
      (void)std::exchange(current, HttpRequest{});
      set_log_request_id("");
    };
  }

  /// Its content may still be on its way, which nobody waits for when the server stops.
  void end_answering() {
    if (begun_at) --answering;
    begun_at.reset();
  }

  /// Unread bytes of a body are never taken for the next request; after a refusal the library tells the
  /// client that we close.
  static void say_if_last(Incoming& incoming, httplib::Response& response) {
    if (response.status >= 400 || incoming.has_unread_body) incoming.close_after = true;
    if (!incoming.close_after) return;
    response.headers.erase("Keep-Alive");
    response.headers.erase("Connection");
    response.set_header("Connection", "close");
  }

  static Exchange exchange_of(const std::string& id, const httplib::Request& request, int status) {
    // What the library refuses before we see it has none of ours.
    if (!begun_at) return {id, request.method, request.path, "", "", request.remote_addr, status, 0};
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - *begun_at;
    return {id,     current.method, current.path, current_route, current.owner, current.address,
            status, elapsed.count()};
  }

  void begin(const httplib::Request& request, const Incoming& incoming) {
    if (!begun_at) ++answering;
    keep_from_bodies(request);
    current = request_of(request, incoming);
    current_route.clear();
    more_headers.clear();
    begun_at = request.start_time_;
    current_id = id_of(incoming.parsed.head);
    set_log_request_id(current_id);
  }

  static bool streams(const FoundRoute& found) { return found.route && found.route->upload; }

  static bool may_bring_body() {
    return current.method == "POST" || current.method == "PUT" || current.method == "PATCH" ||
           current.method == "DELETE";
  }

  std::size_t body_bytes_max(const FoundRoute& found) const {
    const std::size_t own = found.route ? found.route->body_bytes_max : 0;
    return own > 0 ? std::min(own, rules.small_body_bytes_max) : rules.small_body_bytes_max;
  }

  HttpAnswer answer_to(Incoming& incoming) {
    const auto& [head, refused] = incoming.parsed;
    if (refused) return problem(refused->status, refused->detail, current.path);
    BodyReader body(incoming.client, head, stopping);
    HttpAnswer answer = answer_with_body(head, body);
    incoming.has_unread_body = !body.is_over();
    return answer;
  }

  HttpAnswer answer_with_body(const RequestHead& head, BodyReader& body) {
    const FoundRoute found = router.find(current.method, current.path);
    if (auto refused = refuse(head, found)) return std::move(*refused);
    // Of a route that streams, the handler says that a body is missing.
    if (head.body == BodyKind::none) return router.answer(current);
    return streams(found) ? take_upload(found, body) : take_small_body(found, body);
  }

  /// What can be said before the body is there.
  std::optional<HttpAnswer> refuse(const RequestHead& head, const FoundRoute& found) {
    current_route = found.route ? found.route->method + " " + found.route->pattern : "";
    if (auto refused = gate.refuse(current, found.route, more_headers)) return refused;
    if (!may_bring_body() && (head.body_bytes > 0 || head.body == BodyKind::chunked))
      return problem(413, "no body is expected here", current.path);
    if (head.field("Content-Encoding")) return problem(415, "compressed bodies are not taken", current.path);
    if (streams(found)) return found.route->refuse_early ? found.route->refuse_early(current) : std::nullopt;
    if (head.body_bytes > static_cast<std::int64_t>(body_bytes_max(found)))
      return too_large(body_bytes_max(found));
    return std::nullopt;
  }

  static HttpAnswer too_large(std::size_t bytes_max) {
    return problem(413, "a body here may have up to " + std::to_string(bytes_max) + " bytes", current.path);
  }

  BodyPatience patience() const { return {rules.body_silence, rules.upload_grace, rules.upload_bytes_per_s}; }

  HttpAnswer too_slow() const {
    return problem(
        408,
        "the body came in at less than " + std::to_string(rules.upload_bytes_per_s) + " bytes per second",
        current.path);
  }

  HttpAnswer take_small_body(const FoundRoute& found, BodyReader& body) {
    const std::size_t bytes_max = body_bytes_max(found);
    const ReadBody reading = body.reading(static_cast<std::int64_t>(bytes_max), patience());
    const SmallBody came = read_small_body(reading, bytes_max, current.body);
    if (body.too_slow()) return too_slow();
    if (came == SmallBody::too_large || body.too_large()) return too_large(bytes_max);
    if (came == SmallBody::cut_off) return problem(400, "the body ended early", current.path);
    return router.answer(current);
  }

  HttpAnswer take_upload(const FoundRoute& found, BodyReader& body) {
    const std::int64_t bytes_max = rules.upload_bytes_max + kMultipartFrameBytes;
    HttpAnswer answer;
    {
      const Place place(uploads, rules.uploads_max);
      if (!place) return too_many_uploads();
      answer = found.route->upload(current, found.values, body.reading(bytes_max, patience()));
    }
    if (body.too_slow()) return too_slow();
    if (body.too_large()) return too_large(static_cast<std::size_t>(bytes_max));
    return answer.later ? answer.later() : answer;
  }

  static HttpAnswer too_many_uploads() { return problem(503, "too many uploads at once", current.path); }

  static HttpAnswer answer_to_exception(const std::string& path, const std::exception_ptr& thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
      return problem({api::Fault::internal, error.what()}, path);
    } catch (...) {
      return problem({api::Fault::internal, "unknown exception"}, path);
    }
  }

  const Router& router;
  Gate& gate;
  HttpRules rules;
  std::function<void(const Exchange&)> tell;
  std::atomic<bool> stopping = false;
  std::atomic<std::size_t> uploads = 0;
  std::atomic<std::size_t> answering = 0;  ///< requests that have come, and have no answer yet
  int port = 0;
  LibraryServer server;
};

HttpServer::HttpServer(const Router& router, Gate& gate, HttpRules rules,
                       std::function<void(const Exchange&)> tell)
    : library_(std::make_unique<Library>(router, gate, std::move(rules), std::move(tell))) {}

HttpServer::~HttpServer() = default;

api::Status HttpServer::bind() {
  const HttpRules& rules = library_->rules;
  if (rules.port == 0) {
    library_->port = library_->server.bind_to_any_port(rules.host);
    if (library_->port > 0) return api::Done{};
  } else if (library_->server.bind_to_port(rules.host, rules.port)) {
    library_->port = rules.port;
    return api::Done{};
  }
  return api::Error{api::Fault::wrong_state, "cannot listen on " + rules.host + ":" +
                                                 std::to_string(rules.port) +
                                                 "; is another program using that port?"};
}

std::size_t HttpServer::uploads() const {
  return library_->uploads;
}

int HttpServer::port() const {
  return library_->port;
}

bool HttpServer::run() {
  HttpServer::Library& library = *library_;
  return library.server.listen_and_answer({library.rules.threads, library.rules.connections_waiting_max},
                                          library.lobby_rules());
}

void HttpServer::drain(std::chrono::milliseconds patience) {
  library_->server.end_listening();
  const auto end = std::chrono::steady_clock::now() + patience;
  while (library_->answering > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  library_->stopping = true;
}

void HttpServer::stop() {
  library_->stopping = true;
  library_->server.end_listening();
}

}  // namespace server
