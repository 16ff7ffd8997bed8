#include "server/http/parameters.h"

#include <algorithm>

#include "server/http/field_text.h"

namespace server {

std::string percent_encoded(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '-' || c == '.' || c == '_' || c == '~';
    const auto byte = static_cast<unsigned char>(c);
    if (plain)
      encoded += c;
    else
      encoded.append({'%', kDigits[byte >> 4], kDigits[byte & 15]});
  }
  return encoded;
}

std::int64_t wait_preference(std::string_view prefer, std::int64_t most) {
  constexpr std::string_view kWait = "wait=";
  while (!prefer.empty()) {
    const std::string_view entry = take_member(prefer, ",;");
    if (!entry.starts_with(kWait)) continue;
    const auto seconds = whole_number(entry.substr(kWait.size()));
    return seconds ? std::clamp<std::int64_t>(*seconds, 0, most) : 0;
  }
  return 0;
}

}  // namespace server
