#include "engine/scene/names.h"

#include <algorithm>
#include <vector>

#include "api/nearest_name.h"

namespace engine {
namespace {

constexpr std::size_t kExcerptBytes = 40;
constexpr std::size_t kComparedBytes = 100;

/// Bytes of the UTF-8 character at the front of `s`; 0 if it is none (RFC 3629: no overlong forms, no
/// surrogates, nothing above U+10FFFF).
std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return i < s.size() && byte(i) >= low && byte(i) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned low = first == 0xE0 ? 0xA0 : 0x80, high = first == 0xED ? 0x9F : 0xBF;
    return follows(1, low, high) && follows(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned low = first == 0xF0 ? 0x90 : 0x80, high = first == 0xF4 ? 0x8F : 0xBF;
    return follows(1, low, high) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

bool is_utf8(std::string_view s) {
  while (!s.empty()) {
    const std::size_t length = utf8_length(s);
    if (length == 0) return false;
    s.remove_prefix(length);
  }
  return true;
}

std::string from_latin1(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (code >> 6));
      out += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return out;
}

}  // namespace

std::string utf8_name(std::string_view bytes) {
  std::string out = is_utf8(bytes) ? std::string(bytes) : from_latin1(bytes);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return out;
}

std::string excerpt(std::string_view bytes) {
  const std::string text = utf8_name(bytes.substr(0, 4 * kExcerptBytes));
  std::string_view rest = text;
  std::string out = "'";
  while (!rest.empty()) {
    const std::size_t length = utf8_length(rest);
    if (out.size() + length > kExcerptBytes + 1) return out + "...'";
    out += rest.substr(0, length);
    rest.remove_prefix(length);
  }
  return out + "'";
}

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  const std::vector<std::string_view> names(known.begin(), known.end());
  return std::string(api::nearest_name(name, names, kComparedBytes).value_or(""));
}

bool equal_but_for_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

std::string did_you_mean(std::string_view name, std::span<const std::string> known) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?";
}

}  // namespace engine
