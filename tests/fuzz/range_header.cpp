// Range, If-Range and If-None-Match, one per line.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "server/http/conditions.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const auto take_line = [&]() -> std::optional<std::string> {
    if (rest.empty()) return std::nullopt;
    const std::string line(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    return line;
  };
  const auto range = take_line(), if_range = take_line(), if_none_match = take_line();
  server::HttpRequest request;
  request.method = "GET";
  request.header = [&](std::string_view name) -> std::optional<std::string> {
    if (name == "Range") return range;
    if (name == "If-Range") return if_range;
    if (name == "If-None-Match") return if_none_match;
    return std::nullopt;
  };
  server::HttpAnswer answer;
  answer.content_type = "application/octet-stream";
  answer.body = std::string(1000, 'x');
  answer.etag = "0123456789abcdef";
  answer.ranges = true;
  server::apply_conditions(request, answer);
  if (answer.status == 206 && (!answer.part || answer.part->first < 0 || answer.part->count <= 0 ||
                               answer.part->first + answer.part->count > 1000))
    std::abort();
  if (answer.status != 200 && answer.status != 206 && answer.status != 304 && answer.status != 416)
    std::abort();
  return 0;
}
