// Numbers, times and refusals as texts have them.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "api/result.h"

namespace server {

/// Digits only, after a '-' at most; none where there is anything else or too much of it.
inline std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// What somebody asked of a program that it does not do.
inline api::Error wrong_use(std::string message) {
  return {api::Fault::invalid_request, std::move(message)};
}

/// "2026-11-22T08:15:30.123Z" (RFC 3339).
std::string utc_text(std::int64_t time_ms);

}  // namespace server
