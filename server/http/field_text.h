// Words in the values of header fields (RFC 9110, section 5.6).
#pragma once

#include <strings.h>

#include <string_view>

namespace server {

/// Without spaces and tabs at both ends.
inline std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  return text;
}

/// Letters of ASCII, whatever the locale calls a letter.
inline bool same_ignoring_case(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::strncasecmp(a.data(), b.data(), a.size()) == 0;
}

/// Takes the next member off a list: "a, b" -> "a" and leaves "b". `list` must not be empty.
inline std::string_view take_member(std::string_view& list, std::string_view separators = ",") {
  const std::size_t end = list.find_first_of(separators);
  const std::string_view member = trimmed(list.substr(0, end));
  list = end == list.npos ? std::string_view() : list.substr(end + 1);
  return member;
}

/// Of an entity tag in a list, "\"17-3\"" or "W/\"17-3\"", what stands between the quotes; "*" for any;
/// empty: it is none.
inline std::string_view tag_in(std::string_view member) {
  if (member == "*") return member;
  if (member.starts_with("W/")) member.remove_prefix(2);
  if (member.size() < 2 || !member.starts_with('"') || !member.ends_with('"')) return {};
  return member.substr(1, member.size() - 2);
}

}  // namespace server
