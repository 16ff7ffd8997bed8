// The first lines of a request, read strictly: what two programs could read in two ways is refused, because
// the other one may be a proxy that let the request pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace server {

inline constexpr std::size_t kHeadBytesMax = 64 << 10;
inline constexpr std::size_t kHeadLineBytesMax = 8192;  ///< without its end; the request line too
inline constexpr std::size_t kHeadLinesMax = 100;

enum class BodyKind { none, counted, chunked };

struct RequestHead {
  std::string method;
  std::string target;  ///< "/v1/jobs?limit=5", as it came; of an absolute URL the path and the query
  std::vector<std::pair<std::string, std::string>> fields;  ///< as they came, without spaces around values
  BodyKind body = BodyKind::none;
  std::int64_t body_bytes = 0;    ///< of a counted one
  bool closes = false;            ///< the client wants no further answer on this connection
  bool expects_continue = false;  ///< it waits to be told that its body is wanted

  /// Names in any case. Fields of one name are one list (RFC 9110, section 5.3). None: there is no such.
  std::optional<std::string> field(std::string_view name) const;
};

struct HeadRefusal {
  int status = 400;  ///< 400, 413, 414, 417, 431, 501 or 505
  std::string detail;
};

struct ParsedHead {
  RequestHead head;  ///< as far as it was understood
  std::optional<HeadRefusal> refused;
};

/// `text`: all lines up to and with the empty one. Source: RFC 9112, sections 2 to 6.
ParsedHead parse_head(std::string_view text);

}  // namespace server
