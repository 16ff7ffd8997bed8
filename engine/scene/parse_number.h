// One number or index as OBJ and MTL files write them: a point for decimals, whatever the locale.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace engine {

enum class NumberKind { finite, not_finite, not_a_number };

/// Digits with at most one point between them, as nearly all numbers of a file are: both the digits as an
/// integer and the power of ten below it are doubles then, so that their quotient is the nearest to the
/// decimal (W. D. Clinger, "How to read floating point numbers accurately", 1990). False: it is for others
/// to read.
inline bool parse_plain_decimal(const char* at, const char* end, double& value) {
  static constexpr std::array<double, 16> kPowersOfTen{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                       1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool negative = at < end && *at == '-';
  at += negative;
  if (at == end || end - at > 16) return false;  // 15 digits are less than 2^53
  std::uint64_t digits = 0;
  const char* point = nullptr;
  for (const char* c = at; c < end; ++c) {
    const auto digit = static_cast<unsigned>(*c - '0');
    if (digit <= 9)
      digits = 10 * digits + digit;
    else if (*c == '.' && !point)
      point = c;
    else
      return false;
  }
  const std::ptrdiff_t count = end - at - (point ? 1 : 0);
  if (count == 0 || count > 15) return false;
  const auto magnitude =
      static_cast<double>(digits) / kPowersOfTen[static_cast<std::size_t>(point ? end - point - 1 : 0)];
  value = negative ? -magnitude : magnitude;
  return true;
}

/// "1", "-.5", "+2e-3". NaN, inf and what a double cannot hold are not_finite; too small is 0.
inline NumberKind parse_number(std::string_view text, double& value) {
  const char* begin = text.data();
  const char* const end = begin + text.size();
  if (parse_plain_decimal(begin, end, value)) return NumberKind::finite;
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
