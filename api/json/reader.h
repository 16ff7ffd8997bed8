// Reading values out of a parsed document: each function answers the value, or none and says why in the
// findings.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/json/json_text.h"
#include "api/result.h"
#include "api/scene_description.h"

namespace api {

/// What is wrong with one document, up to kViolationsMax.
struct Findings {
  std::string file;
  std::vector<Violation> violations;
  /// Pointer to a member that is not there -> the name of the unknown one beside it that was meant.
  std::map<std::string, std::string, std::less<>> misspelt = {};
};

/// A value of the document, where it stands, and where to say what is wrong with it.
struct Node {
  const ParsedJson* json = nullptr;
  std::string pointer;
  Findings* findings = nullptr;
};

void add_violation(const Node& node, std::string_view code, std::string detail);
/// The violation concerns a member that is not there.
void add_violation(const Node& parent, std::string_view member, std::string_view code, std::string detail);

/// True for an object; its members outside `known` are violations, each with a suggestion.
bool is_object_of(const Node& node, std::span<const std::string_view> known);
bool is_object_of(const Node& node, std::initializer_list<std::string_view> known);
/// True for an object with any names, at most `most` of them.
bool is_object_of_at_most(const Node& node, std::size_t most);
/// True for an array of `least` .. `most` elements.
bool is_array_of(const Node& node, std::size_t least, std::size_t most);

/// A member, if it is there; of `required`, its absence is a violation. `object` must be an object. One whose
/// name is misspelt, as is_object_of has said, is taken as what it was meant to be: no errors that only
/// follow.
std::optional<Node> member(const Node& object, std::string_view name);
std::optional<Node> required(const Node& object, std::string_view name);
Node element(const Node& array, std::size_t index);
std::vector<std::pair<std::string, Node>> members(const Node& object);

struct Range {
  double lowest;
  double highest;
  bool lowest_excluded = false;
  bool highest_excluded = false;
};

/// `why` is added to the detail where the number is out of range.
std::optional<double> number(const Node& node, const Range& range, std::string_view why = {});
/// Whole numbers only: 24 and 24.0, never 1.5.
std::optional<std::uint64_t> whole(const Node& node, std::uint64_t lowest, std::uint64_t highest,
                                   std::string_view why = {});
std::optional<bool> boolean(const Node& node);
std::optional<std::string> text(const Node& node, std::size_t most_bytes);
/// A name or title: no control characters. Says so and answers false otherwise.
bool is_printable(const Node& node, std::string_view name, std::size_t most_bytes);
/// Exactly `values.size()` numbers, each within `range`.
bool numbers(const Node& node, std::span<double> values, const Range& range);
std::optional<Vec3> vec3(const Node& node, const Range& range);
/// A number for all three, or three numbers.
std::optional<Vec3> number_or_vec3(const Node& node, const Range& range);

/// The enumerator that stands beside the node's text in `names`.
template <class Enum>
struct Named {
  std::string_view name;
  Enum value;
};
/// Index into `names`, or none.
std::optional<std::size_t> one_of(const Node& node, std::span<const std::string_view> names);
template <class Enum>
std::optional<Enum> one_of(const Node& node, std::span<const Named<Enum>> table) {
  std::vector<std::string_view> names;
  for (const auto& row : table) names.push_back(row.name);
  const auto index = one_of(node, names);
  if (!index) return std::nullopt;
  return table[*index].value;
}

template <class Enum, std::size_t n>
std::optional<Enum> one_of(const Node& node, const std::array<Named<Enum>, n>& table) {
  return one_of(node, std::span<const Named<Enum>>(table));
}

/// `given` replaces `value` if it is there and right.
template <class T, class U>
void take(const std::optional<T>& given, U& value) {
  if (given) value = static_cast<U>(*given);
}

}  // namespace api
