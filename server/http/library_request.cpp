#include "server/http/library_request.h"

#include <string>

namespace server {
namespace {

constexpr std::string_view kContentTypeAside = "X-Keylume-Content-Type";

/// The library hands out a constant reference to an object that is not constant.
httplib::Request& writable(const httplib::Request& from) {
  return const_cast<httplib::Request&>(from);
}

}  // namespace

HttpRequest request_of(const httplib::Request& from) {
  HttpRequest request{from.method, from.path, {}, {}, {}, {}, from.remote_addr, false};
  for (const auto& [name, value] : from.params) request.query.emplace_back(name, value);
  request.header = [&from](std::string_view name) -> std::optional<std::string> {
    const std::string key(name == "Content-Type" ? kContentTypeAside : name);
    if (!from.has_header(key)) return std::nullopt;
    return from.get_header_value(key);
  };
  return request;
}

void take_over(const httplib::Request& from) {
  httplib::Request& request = writable(from);
  // Ranges are answered by apply_conditions; the library would cut our answer a second time.
  request.ranges.clear();
  // Without a length there is no body (RFC 9112, section 6.3). The library would wait for one after the
  // answer, and take the connection's next request for it.
  if (!brings_body(from)) request.body_consumed_ = true;
  // Bodies reach us as bytes: seeing multipart, the library would parse it, in memory without bounds.
  const auto [first, last] = request.headers.equal_range("Content-Type");
  if (first == last) return;
  const std::string type = first->second;
  request.headers.erase(first, last);
  request.headers.erase(std::string(kContentTypeAside));
  request.headers.emplace(kContentTypeAside, type);
}

void lead_to_body_handler(const httplib::Request& from) {
  writable(from).path = kBodyPath;
}

void restore_path(const httplib::Request& from, const std::string& path) {
  writable(from).path = path;
}

bool brings_body(const httplib::Request& from) {
  return from.has_header("Content-Length") || from.has_header("Transfer-Encoding");
}

std::int64_t announced_bytes(const httplib::Request& from) {
  return static_cast<std::int64_t>(from.get_header_value_u64("Content-Length"));
}

bool has_much_left(const httplib::Request& from) {
  return from.has_header("Transfer-Encoding") || announced_bytes(from) > kDropBytesMax;
}

void expect_only(std::int64_t bytes, const httplib::Request& from) {
  auto& headers = writable(from).headers;
  headers.erase("Content-Length");
  headers.emplace("Content-Length", std::to_string(bytes));
}

void body_is_read(const httplib::Request& from) {
  writable(from).body_consumed_ = true;
}

}  // namespace server
