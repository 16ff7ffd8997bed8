// One number or index as OBJ and MTL files write them: a point for decimals, whatever the locale.
#pragma once

#include <charconv>
#include <cmath>
#include <string_view>

namespace engine {

enum class NumberKind { finite, not_finite, not_a_number };

/// "1", "-.5", "+2e-3". NaN, inf and what a double cannot hold are not_finite; too small is 0.
inline NumberKind parse_number(std::string_view text, double& value) {
  const char* begin = text.data();
  const char* const end = begin + text.size();
  if (text.size() > 1 && *begin == '+' && begin[1] != '-' && begin[1] != '+') ++begin;
  const auto [stop, problem] = std::from_chars(begin, end, value);
  if (problem == std::errc::invalid_argument || stop != end) return NumberKind::not_a_number;
  if (problem == std::errc::result_out_of_range) {
    const bool tiny = text.find("e-") != text.npos || text.find("E-") != text.npos;
    value = 0;
    return tiny ? NumberKind::finite : NumberKind::not_finite;
  }
  return std::isfinite(value) ? NumberKind::finite : NumberKind::not_finite;
}

}  // namespace engine
