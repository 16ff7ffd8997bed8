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
#include "server/http/problem.h"
#include "server/log.h"

namespace server {
namespace {

constexpr time_t kReadSeconds = 10;
constexpr time_t kWriteSeconds = 30;
constexpr time_t kKeepAliveSeconds = 2;  // an idle connection holds a thread
constexpr std::size_t kKeepAliveRequests = 1000;
constexpr std::size_t kMultipartFrameBytes = 1 << 20;
constexpr std::size_t kRequestIdBytesMax = 64;

/// The request that this thread is answering: a thread has one at a time.
thread_local HttpRequest current;
thread_local std::string current_route;
thread_local std::string current_id;
thread_local std::optional<std::chrono::steady_clock::time_point> begun_at;  ///< none: we never saw it
thread_local bool admitted = false;  ///< already, while the client waits to be told to go on
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
std::string id_of(const httplib::Request& request) {
  const std::string given = request.get_header_value("X-Request-Id");
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

/// One of a number of places, for as long as it lives; none is taken where it is not `counted`.
class Place {
 public:
  Place(std::atomic<std::size_t>& taken, std::size_t most, bool counted)
      : taken_(counted ? &taken : nullptr), ours_(!counted || ++taken <= most) {}
  ~Place() {
    if (taken_) --*taken_;
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  explicit operator bool() const { return ours_; }

 private:
  std::atomic<std::size_t>* taken_;
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
    server.new_task_queue = [this] {
      return new httplib::ThreadPool(rules.threads, rules.threads, rules.connections_waiting_max);
    };
    // The library's default shares the port with whoever else asks for it.
    server.set_socket_options([](auto socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.set_tcp_nodelay(true);  // otherwise every answer waits for the client's delayed acknowledgement
    server.set_keep_alive_max_count(kKeepAliveRequests);
    server.set_keep_alive_timeout(kKeepAliveSeconds);
    server.set_read_timeout(kReadSeconds);
    server.set_write_timeout(kWriteSeconds);
    server.set_payload_max_length(static_cast<std::size_t>(rules.upload_bytes_max) + kMultipartFrameBytes);
  }

  void set_handlers() {
    using Handled = httplib::Server::HandlerResponse;
    server.set_pre_routing_handler([this](const auto& request, auto& response) {
      const bool asked_before = std::exchange(admitted, false);
      if (!asked_before) begin(request);
      const FoundRoute found = router.find(current.method, current.path);
      const auto refused = asked_before ? std::nullopt : refuse(request, found);
      if (refused) {
        refuse_unread(*refused, stopping, request, response);
      } else if (takes_body(request, found)) {
        lead_to_body_handler(request);
        return Handled::Unhandled;
      } else {
        send(router.answer(current), stopping, response);
      }
      return Handled::Handled;
    });
    const auto with_body = [this](const auto& request, auto& response, const auto& reader) {
      restore_path(request, current.path);
      take_body(request, response, reader);
    };
    server.Post(kBodyPath, with_body);
    server.Put(kBodyPath, with_body);
    server.Patch(kBodyPath, with_body);
    server.Delete(kBodyPath, with_body);
    server.set_expect_100_continue_handler([this](const auto& request, auto& response) {
      begin(request);
      const FoundRoute found = router.find(current.method, current.path);
      auto refused = refuse(request, found);
      if (!refused && streams(found) && uploads >= rules.uploads_max) refused = too_many_uploads();
      admitted = !refused;
      if (admitted) return 100;
      send(*refused, stopping, response);
      return refused->status;
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
      const std::string id = begun_at ? current_id : id_of(request);
      response.set_header("X-Request-Id", id);
      for (const auto& [name, value] : std::exchange(more_headers, {})) response.set_header(name, value);
      set_safe_headers(response);
      if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
      if (begun_at) --answering;
      if (tell) tell(exchange_of(id, request, response.status));
      begun_at.reset();
      set_log_request_id("");
    });
  }

  static Exchange exchange_of(const std::string& id, const httplib::Request& request, int status) {
    // What the library refuses before we see it has none of ours.
    if (!begun_at) return {id, request.method, request.path, "", "", request.remote_addr, status, 0};
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - *begun_at;
    return {id,     current.method, current.path, current_route, current.owner, current.address,
            status, elapsed.count()};
  }

  void begin(const httplib::Request& request) {
    if (!begun_at) ++answering;
    take_over(request);
    current = request_of(request);
    begun_at = request.start_time_;
    current_id = id_of(request);
    set_log_request_id(current_id);
  }

  static bool streams(const FoundRoute& found) { return found.route && found.route->upload; }

  static bool may_bring_body(const httplib::Request& request) {
    return request.method == "POST" || request.method == "PUT" || request.method == "PATCH" ||
           request.method == "DELETE";
  }

  static bool takes_body(const httplib::Request& request, const FoundRoute& found) {
    return streams(found) || (may_bring_body(request) && brings_body(request));
  }

  /// What can be said before the body is there.
  std::optional<HttpAnswer> refuse(const httplib::Request& request, const FoundRoute& found) {
    more_headers.clear();
    current_route = found.route ? found.route->method + " " + found.route->pattern : "";
    if (auto refused = gate.refuse(current, found.route, more_headers)) return refused;
    if (!may_bring_body(request) && (announced_bytes(request) > 0 || request.has_header("Transfer-Encoding")))
      return problem(413, "no body is expected here", current.path);
    if (request.has_header("Content-Encoding"))
      return problem(415, "compressed bodies are not taken", current.path);
    if (streams(found)) return found.route->refuse_early ? found.route->refuse_early(current) : std::nullopt;
    if (announced_bytes(request) > static_cast<std::int64_t>(rules.small_body_bytes_max)) return too_large();
    return std::nullopt;
  }

  HttpAnswer too_large() const {
    return problem(413, "a body here may have up to " + std::to_string(rules.small_body_bytes_max) + " bytes",
                   current.path);
  }

  HttpAnswer answer_with_body(BodyReader& body) {
    const FoundRoute found = router.find(current.method, current.path);
    if (streams(found)) return found.route->upload(current, found.values, body.reading());
    switch (read_small_body(body.reading(), rules.small_body_bytes_max, current.body)) {
      case SmallBody::too_large:
        return too_large();
      case SmallBody::cut_off:
        return problem(400, "the body ended early", current.path);
      case SmallBody::whole:
        break;
    }
    return router.answer(current);
  }

  void take_body(const httplib::Request& request, httplib::Response& response,
                 const httplib::ContentReader& reader) {
    const bool upload = streams(router.find(current.method, current.path));
    const Place place(uploads, rules.uploads_max, upload);
    if (!place) return refuse_unread(too_many_uploads(), stopping, request, response);
    BodyReader body(reader, {rules.upload_grace, rules.upload_bytes_per_s}, stopping);
    HttpAnswer answer = answer_with_body(body);
    if (body.too_slow())
      answer = problem(
          408,
          "the body came in at less than " + std::to_string(rules.upload_bytes_per_s) + " bytes per second",
          current.path);
    send(answer, stopping, response);
    if (request.body_consumed_) return;
    const auto rest = body.rest_of(announced_bytes(request));
    if (rest && *rest <= kDropBytesMax)
      expect_only(*rest, request);
    else if (body.begun() || has_much_left(request))
      send_and_close(answer, request, response);
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
  std::atomic<bool> stopped = false;
  std::atomic<std::size_t> uploads = 0;
  std::atomic<std::size_t> answering = 0;  ///< requests that have come, and have no answer yet
  int port = 0;
  httplib::Server server;
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
  return library_->server.listen_after_bind() || library_->stopping;
}

void HttpServer::drain(std::chrono::milliseconds patience) {
  library_->stopped = true;
  library_->server.wait_until_ready();
  library_->server.stop();
  const auto end = std::chrono::steady_clock::now() + patience;
  while (library_->answering > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  library_->stopping = true;
}

void HttpServer::stop() {
  library_->stopping = true;
  // The library forgets a stop that comes before its loop has begun.
  if (!library_->stopped.exchange(true)) {
    library_->server.wait_until_ready();
    library_->server.stop();
  }
}

}  // namespace server
