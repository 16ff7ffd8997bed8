#include "server/http/request_head.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "server/http/field_text.h"

namespace server {
namespace {

constexpr std::string_view kHeadLineEnd = "\r\n";

bool is_token(std::string_view text) {
  constexpr std::string_view kMarks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           kMarks.find(c) != kMarks.npos;
  });
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

using Refused = std::optional<HeadRefusal>;

/// Of an absolute URL the part after the authority, which must be what Host says. None: it is no such URL.
std::optional<std::string> path_of_url(std::string_view target, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!same_ignoring_case(target.substr(0, scheme.size()), scheme)) continue;
    const std::string_view rest = target.substr(scheme.size());
    const std::size_t end = rest.find_first_of("/?");
    if (!same_ignoring_case(rest.substr(0, end), host)) return std::nullopt;
    const std::string path(end == rest.npos ? "" : rest.substr(end));
    return path.starts_with('/') ? path : "/" + path;
  }
  return std::nullopt;
}

class Parser {
 public:
  explicit Parser(std::string_view text) : rest_(text) {}

  ParsedHead parse() {
    Refused refused = take_request_line(next_line());
    while (!refused) {
      const auto line = next_line();
      if (line && line->empty()) break;
      refused = take_field(line);
    }
    if (!refused) refused = check_host();
    if (!refused) refused = find_body();
    if (!refused) refused = find_expectations();
    return {std::move(head_), std::move(refused)};
  }

 private:
  /// None: it does not end, or not as a line must.
  std::optional<std::string_view> next_line() {
    const std::size_t end = rest_.find('\n');
    if (end == rest_.npos || end == 0 || rest_[end - 1] != '\r') return std::nullopt;
    const std::string_view line = rest_.substr(0, end - 1);
    rest_.remove_prefix(end + 1);
    return line;
  }

  Refused take_request_line(std::optional<std::string_view> line) {
    if (!line) return HeadRefusal{400, "the request line must end in CR LF"};
    const std::size_t first = line->find(' '), last = line->rfind(' ');
    if (first == line->npos || first == last)
      return HeadRefusal{400, "the request line must be a method, a target and a version"};
    const std::string_view method = line->substr(0, first);
    const std::string_view target = line->substr(first + 1, last - first - 1);
    const std::string_view version = line->substr(last + 1);
    if (!is_token(method)) return HeadRefusal{400, "the method is no word"};
    if (target.size() > kHeadLineBytesMax) return HeadRefusal{414, "the path and its query are too long"};
    if (target.empty() ||
        std::any_of(target.begin(), target.end(), [](char c) { return is_control(c) || c == ' '; }))
      return HeadRefusal{400, "the path holds a space or a control character"};
    if (version != "HTTP/1.1" && version != "HTTP/1.0")
      return version.starts_with("HTTP/") ? HeadRefusal{505, "HTTP/1.1 is spoken here"}
                                          : HeadRefusal{400, "the request line does not end in a version"};
    constexpr std::array<std::string_view, 9> kMethods{"GET",    "HEAD",    "POST",  "PUT",    "PATCH",
                                                       "DELETE", "OPTIONS", "TRACE", "CONNECT"};
    if (std::find(kMethods.begin(), kMethods.end(), method) == kMethods.end())
      return HeadRefusal{501, "no such method is known here"};
    head_.method = method;
    head_.target = target;
    is_1_0_ = version == "HTTP/1.0";
    head_.closes = is_1_0_;
    return std::nullopt;
  }

  Refused take_field(std::optional<std::string_view> line) {
    if (!line) return HeadRefusal{400, "a header must end in CR LF"};
    if (head_.fields.size() >= kHeadLinesMax)
      return HeadRefusal{431, "at most " + std::to_string(kHeadLinesMax) + " headers are taken"};
    if (line->size() > kHeadLineBytesMax)
      return HeadRefusal{431, "a header is at most " + std::to_string(kHeadLineBytesMax) + " bytes"};
    const std::size_t colon = line->find(':');
    // A space before the colon, or instead of a name, has let requests past proxies.
    if (colon == line->npos || !is_token(line->substr(0, colon)))
      return HeadRefusal{400, "a header must be NAME: VALUE"};
    const std::string_view value = trimmed(line->substr(colon + 1));
    if (std::any_of(value.begin(), value.end(), [](char c) { return is_control(c) && c != '\t'; }))
      return HeadRefusal{400, "a header holds a control character"};
    head_.fields.emplace_back(line->substr(0, colon), value);
    return std::nullopt;
  }

  std::size_t count(std::string_view name) const {
    return static_cast<std::size_t>(
        std::count_if(head_.fields.begin(), head_.fields.end(),
                      [&](const auto& field) { return same_ignoring_case(field.first, name); }));
  }

  Refused check_host() {
    const std::size_t hosts = count("Host");
    if (hosts > 1 || (hosts == 0 && !is_1_0_))
      return HeadRefusal{400, "a request needs the header Host, once"};
    if (head_.target.starts_with('/')) return std::nullopt;
    auto path = path_of_url(head_.target, head_.field("Host").value_or(""));
    if (!path) return HeadRefusal{400, "the target must be a path, or a URL of the host that Host names"};
    head_.target = std::move(*path);
    return std::nullopt;
  }

  Refused find_body() {
    const std::size_t lengths = count("Content-Length"), codings = count("Transfer-Encoding");
    if (lengths + codings > 1)
      return HeadRefusal{400,
                         "the length of the body must be said once: Content-Length or Transfer-Encoding"};
    if (codings == 1) return find_coding();
    return lengths == 1 ? find_length(*head_.field("Content-Length")) : std::nullopt;
  }

  Refused find_coding() {
    if (is_1_0_) return HeadRefusal{400, "HTTP/1.0 has no Transfer-Encoding"};
    if (!same_ignoring_case(*head_.field("Transfer-Encoding"), "chunked"))
      return HeadRefusal{501, "no Transfer-Encoding but chunked is taken"};
    head_.body = BodyKind::chunked;
    return std::nullopt;
  }

  Refused find_length(std::string_view text) {
    if (text.empty() || text.find_first_not_of("0123456789") != text.npos)
      return HeadRefusal{400, "Content-Length must be a number"};
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), head_.body_bytes);
    if (parsed.ec != std::errc())
      return HeadRefusal{413, "no body may be as long as its Content-Length says"};
    head_.body = BodyKind::counted;
    return std::nullopt;
  }

  Refused find_expectations() {
    const std::string connection = head_.field("Connection").value_or("");
    std::string_view rest = connection;
    while (!rest.empty())
      if (same_ignoring_case(take_member(rest), "close")) head_.closes = true;
    const auto expected = head_.field("Expect");
    if (!expected || is_1_0_) return std::nullopt;
    if (!same_ignoring_case(*expected, "100-continue"))
      return HeadRefusal{417, "nothing can be expected but 100-continue"};
    head_.expects_continue = true;
    return std::nullopt;
  }

  std::string_view rest_;
  RequestHead head_;
  bool is_1_0_ = false;
};

}  // namespace

std::optional<std::string> RequestHead::field(std::string_view name) const {
  std::optional<std::string> value;
  const std::string_view between = same_ignoring_case(name, "Cookie") ? "; " : ", ";
  for (const auto& [key, text] : fields) {
    if (!same_ignoring_case(key, name)) continue;
    if (value)
      value->append(between).append(text);
    else
      value = text;
  }
  return value;
}

ParsedHead parse_head(std::string_view text) {
  // Some clients end a body with a line of its own, before the next request (RFC 9112, section 2.2).
  if (text.starts_with(kHeadLineEnd)) text.remove_prefix(kHeadLineEnd.size());
  return Parser(text).parse();
}

}  // namespace server
