#include "server/http/http_server.h"

// Many clients may connect at once; the library's own backlog is 5.
#define CPPHTTPLIB_LISTEN_BACKLOG 128
#include <httplib.h>

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "server/http/origin.h"
#include "server/http/problem.h"
#include "server/http/routes.h"
#include "server/log.h"

namespace server {
namespace {

constexpr time_t kReadSeconds = 10;
constexpr time_t kWriteSeconds = 30;
// What is left of a refused upload is read up to here, so that a client that looks for the answer only when
// it has sent everything gets to see it.
constexpr std::int64_t kDropBytesMax = 16 << 20;
constexpr time_t kKeepAliveSeconds = 2;  // an idle connection holds a thread
constexpr std::size_t kKeepAliveRequests = 1000;
constexpr std::size_t kMultipartFrameBytes = 1 << 20;
constexpr std::size_t kPieceBytes = 64 * 1024;
constexpr std::size_t kRequestIdBytesMax = 64;
constexpr std::string_view kContentTypeAside = "X-Keylume-Content-Type";

HttpRequest request_of(const httplib::Request& from) {
  HttpRequest request{from.method, from.path, {}, {}};
  for (const auto& [name, value] : from.params) request.query.emplace_back(name, value);
  request.header = [&from](std::string_view name) -> std::optional<std::string> {
    const std::string key(name == "Content-Type" ? kContentTypeAside : name);
    if (!from.has_header(key)) return std::nullopt;
    return from.get_header_value(key);
  };
  return request;
}

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

bool is_upload(const httplib::Request& request) {
  return request.method == "POST" && (request.path == kSubmitPath || request.path == kValidatePath);
}

/// What the library decided about the request before we saw it, put right. It hands out a constant
/// reference to an object that is not constant.
void take_over(const httplib::Request& from) {
  auto& request = const_cast<httplib::Request&>(from);
  // Ranges are answered by apply_conditions; the library would cut our answer a second time.
  request.ranges.clear();
  // Without a length there is no body (RFC 9112, section 6.3). The library would wait for one after the
  // answer, and take the connection's next request for it.
  if (!request.has_header("Content-Length") && !request.has_header("Transfer-Encoding"))
    request.body_consumed_ = true;
  // Bodies reach us as bytes: seeing multipart, the library would parse it, in memory without bounds.
  const auto [first, last] = request.headers.equal_range("Content-Type");
  if (first == last) return;
  const std::string type = first->second;
  request.headers.erase(first, last);
  request.headers.erase(std::string(kContentTypeAside));
  request.headers.emplace(kContentTypeAside, type);
}

void send_file(const HttpAnswer& answer, ByteRange part, const std::atomic<bool>& stopping,
               httplib::Response& response) {
  auto provider = [file = answer.file, first = part.first, &stopping](std::size_t at, std::size_t count,
                                                                      httplib::DataSink& sink) {
    std::array<char, kPieceBytes> piece;
    const auto wanted = static_cast<std::int64_t>(std::min(count, piece.size()));
    const std::int64_t got = file->read(first + static_cast<std::int64_t>(at), piece.data(), wanted);
    return !stopping && got > 0 && sink.write(piece.data(), static_cast<std::size_t>(got));
  };
  response.set_content_provider(static_cast<std::size_t>(part.count), answer.content_type,
                                std::move(provider));
}

void send(const HttpAnswer& answer, const std::atomic<bool>& stopping, httplib::Response& response) {
  response.status = answer.status;
  for (const auto& [name, value] : answer.headers) response.set_header(name, value);
  if (!answer.etag.empty()) response.set_header("ETag", "\"" + answer.etag + "\"");
  if (answer.ranges) response.set_header("Accept-Ranges", "bytes");
  if (answer.content_type.empty()) return;
  const ByteRange part = answer.part.value_or(ByteRange{0, answer.size()});
  if (answer.file && part.count > 0)
    send_file(answer, part, stopping, response);
  else
    response.set_content(
        answer.body.substr(static_cast<std::size_t>(part.first), static_cast<std::size_t>(part.count)),
        answer.content_type);
}

/// The body of one upload, as it comes in.
class UploadBody {
 public:
  UploadBody(const httplib::ContentReader& reader, const HttpRules& rules, const std::atomic<bool>& stopping)
      : reader_(reader), rules_(rules), stopping_(stopping) {}

  ReadBody reading() {
    return [this](const std::function<bool(std::string_view)>& take) {
      asked_for_ = true;
      return reader_([&](const char* bytes, std::size_t count) {
        bytes_ += static_cast<std::int64_t>(count);
        if (stopping_ || is_too_slow()) return false;
        refused_ = !take({bytes, count});
        return !refused_;
      });
    };
  }
  bool begun() const { return asked_for_; }
  bool too_slow() const { return too_slow_; }
  /// What the refused body of this announced length still has to bring; none: nobody knows, or not refused.
  std::optional<std::int64_t> rest_of(std::int64_t announced) const {
    if (!refused_ || announced < bytes_) return std::nullopt;
    return announced - bytes_;
  }

 private:
  using SteadyClock = std::chrono::steady_clock;

  bool is_too_slow() {
    const std::chrono::duration<double> elapsed = SteadyClock::now() - begun_;
    too_slow_ =
        elapsed > rules_.upload_grace &&
        static_cast<double>(bytes_) < elapsed.count() * static_cast<double>(rules_.upload_bytes_per_s);
    return too_slow_;
  }

  const httplib::ContentReader& reader_;
  const HttpRules& rules_;
  const std::atomic<bool>& stopping_;
  const SteadyClock::time_point begun_ = SteadyClock::now();
  std::int64_t bytes_ = 0;
  bool asked_for_ = false;
  bool refused_ = false;
  bool too_slow_ = false;
};

/// Is its unread body longer than is worth reading for the sake of the answer, or of unknown length?
bool has_much_left(const httplib::Request& request) {
  return request.has_header("Transfer-Encoding") ||
         request.get_header_value_u64("Content-Length") > static_cast<std::size_t>(kDropBytesMax);
}

/// The library waits for the whole body before it takes the next request, also where we have read a part.
void expect_only(std::int64_t bytes, const httplib::Request& from) {
  auto& headers = const_cast<httplib::Request&>(from).headers;
  headers.erase("Content-Length");
  headers.emplace("Content-Length", std::to_string(bytes));
}

/// Has the library close the connection after this answer, unread bytes and all, which it does only where an
/// answer fails.
void send_and_close(const HttpAnswer& answer, const httplib::Request& from, httplib::Response& response) {
  const_cast<httplib::Request&>(from).body_consumed_ = true;
  response.body.clear();
  response.set_content_provider(answer.body.size(), answer.content_type,
                                [body = answer.body](std::size_t at, std::size_t count, auto& sink) {
                                  (void)sink.write(body.data() + at, count);
                                  return false;
                                });
}

/// The library would read the body to its end, gigabytes perhaps, on a thread that others need.
void refuse_unread(const HttpAnswer& answer, const std::atomic<bool>& stopping, const httplib::Request& from,
                   httplib::Response& response) {
  send(answer, stopping, response);
  if (has_much_left(from)) send_and_close(answer, from, response);
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
  Library(const Router& router_, JobService& jobs_, const DataFolder& folder_, HttpRules rules_)
      : router(router_), jobs(jobs_), folder(folder_), rules(std::move(rules_)) {
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
    server.set_payload_max_length(static_cast<std::size_t>(rules.upload.total_bytes) + kMultipartFrameBytes);
  }

  void set_handlers() {
    using Handled = httplib::Server::HandlerResponse;
    server.set_pre_routing_handler([this](const auto& request, auto& response) {
      take_over(request);
      const HttpRequest ours = request_of(request);
      if (const auto refused = refuse_stranger(ours, rules.this_machine_only))
        refuse_unread(*refused, stopping, request, response);
      else if (is_upload(request))
        return Handled::Unhandled;
      else if (request.get_header_value_u64("Content-Length") > static_cast<std::size_t>(kDropBytesMax))
        refuse_unread(problem(413, "no body is expected here", request.path), stopping, request, response);
      else
        send(router.answer(ours), stopping, response);
      return Handled::Handled;
    });
    for (const std::string_view path : {kSubmitPath, kValidatePath})
      server.Post(std::string(path), [this](const auto& request, auto& response, const auto& reader) {
        take_upload(request, response, reader);
      });
    server.set_expect_100_continue_handler([this](const auto& request, auto& response) {
      if (!is_upload(request)) return 100;
      take_over(request);
      const HttpRequest ours = request_of(request);
      auto refused = refuse_stranger(ours, rules.this_machine_only);
      if (!refused && uploads >= rules.uploads_max) refused = too_many_uploads(request);
      if (!refused) refused = refuse_upload_early(ours, folder, rules.upload);
      if (!refused) return 100;
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
    server.set_post_routing_handler([](const auto& request, auto& response) {
      const std::string given = request.get_header_value("X-Request-Id");
      response.set_header("X-Request-Id", is_request_id(given) ? given : new_request_id());
      response.set_header("X-Content-Type-Options", "nosniff");
      if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
    });
  }

  void take_upload(const httplib::Request& request, httplib::Response& response,
                   const httplib::ContentReader& reader) {
    const Place place(uploads, rules.uploads_max);
    if (!place) return refuse_unread(too_many_uploads(request), stopping, request, response);
    UploadBody body(reader, rules, stopping);
    HttpAnswer answer = take_job(request_of(request), body.reading(), jobs, folder, rules.upload);
    if (body.too_slow())
      answer = problem(
          408,
          "the upload came in at less than " + std::to_string(rules.upload_bytes_per_s) + " bytes per second",
          request.path);
    send(answer, stopping, response);
    if (request.body_consumed_) return;
    const auto rest = body.rest_of(static_cast<std::int64_t>(request.get_header_value_u64("Content-Length")));
    if (rest && *rest <= kDropBytesMax)
      expect_only(*rest, request);
    else if (body.begun() || has_much_left(request))
      send_and_close(answer, request, response);
  }

  static HttpAnswer too_many_uploads(const httplib::Request& request) {
    return problem(503, "too many uploads at once", request.path);
  }

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
  JobService& jobs;
  const DataFolder& folder;
  HttpRules rules;
  std::atomic<bool> stopping = false;
  std::atomic<std::size_t> uploads = 0;
  int port = 0;
  httplib::Server server;
};

HttpServer::HttpServer(const Router& router, JobService& jobs, const DataFolder& folder, HttpRules rules)
    : library_(std::make_unique<Library>(router, jobs, folder, std::move(rules))) {}

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

int HttpServer::port() const {
  return library_->port;
}

bool HttpServer::run() {
  return library_->server.listen_after_bind() || library_->stopping;
}

void HttpServer::stop() {
  library_->stopping = true;
  // The library forgets a stop that comes before its loop has begun.
  library_->server.wait_until_ready();
  library_->server.stop();
}

}  // namespace server
