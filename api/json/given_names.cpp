#include "api/given_names.h"

#include <algorithm>

#include "api/json/json_text.h"

namespace api {
namespace {

bool is_of_a_word(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
}

/// Does `name` stand at `at` by itself, and not as a part of a longer name or of a path?
bool stands_at(std::string_view text, std::size_t at, std::string_view name) {
  if (text.substr(at, name.size()) != name) return false;
  const bool begins = at == 0 || !(is_of_a_word(text[at - 1]) || text[at - 1] == '/' || text[at - 1] == '.');
  const std::size_t end = at + name.size();
  return begins && (end == text.size() || !is_of_a_word(text[end]));
}

}  // namespace

std::string given_names_json(const GivenNames& names) {
  return json_text(Json(names));
}

GivenNames parse_given_names(std::string_view bytes) {
  GivenNames names;
  const auto json = parse_json(bytes, kGivenNamesFile, {kGivenNamesBytesMax, 2, 16});
  if (!json || !json->is_object()) return names;
  for (const auto& [kept, given] : json->items())
    if (!kept.empty() && given.is_string()) names.emplace(kept, given.get<std::string>());
  return names;
}

std::string with_given_names(std::string_view text, const GivenNames& names) {
  std::string changed;
  for (std::size_t at = 0; at < text.size();) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const auto& name) { return stands_at(text, at, name.first); });
    if (found == names.end()) {
      changed += text[at++];
    } else {
      changed += found->second;
      at += found->first.size();
    }
  }
  return changed;
}

}  // namespace api
