#include "api/json/reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "api/json/strict_check.h"
#include "api/nearest_name.h"
#include "api/pointer_step.h"

namespace api {
namespace {

constexpr double kExactWholeMax = 9007199254740992.0;  // 2^53: beyond it a double skips whole numbers

std::string short_text(double value) {
  // For people: 1000000 rather than 1e+06.
  const bool plain = value == 0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e10);
  std::array<char, 64> buffer{};
  const auto format = plain ? std::chars_format::fixed : std::chars_format::general;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format).ptr;
  return {buffer.data(), end};
}

std::string_view type_name(const ParsedJson& json) {
  switch (json.type()) {
    case ParsedJson::value_t::object:
      return "an object";
    case ParsedJson::value_t::array:
      return "an array";
    case ParsedJson::value_t::string:
      return "a string";
    case ParsedJson::value_t::boolean:
      return json.get<bool>() ? "true" : "false";
    case ParsedJson::value_t::null:
      return "null";
    default:
      return "a number";
  }
}

void add_wrong_type(const Node& node, std::string_view expected) {
  const std::string got = node.json->is_number() ? node.json->dump() : std::string(type_name(*node.json));
  add_violation(node, "wrong_type", "must be " + std::string(expected) + ", got " + got);
}

std::string range_text(const Range& range) {
  return (range.lowest_excluded ? "greater than " : "at least ") + short_text(range.lowest) + " and " +
         (range.highest_excluded ? "less than " : "at most ") + short_text(range.highest);
}

bool contains(const Range& range, double value) {
  return (range.lowest_excluded ? value > range.lowest : value >= range.lowest) &&
         (range.highest_excluded ? value < range.highest : value <= range.highest);
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// Takes an unknown member as the one whose name is much like its own, where that is not there: two thirds of
/// the letters are right. A suggestion is made sooner, and may be wrong.
void take_as_meant(const Node& object, const std::string& name, std::span<const std::string_view> known) {
  const auto meant = nearest_name(name, known);
  if (!meant || 3 * edit_distance(name, *meant) > meant->size() + 1 || object.json->contains(*meant)) return;
  object.findings->misspelt.emplace(object.pointer + '/' + pointer_step(*meant), name);
}

/// The value as a whole number, none where it is negative or too large for one.
std::optional<std::uint64_t> as_whole(const ParsedJson& json) {
  if (json.is_number_unsigned()) return json.get<std::uint64_t>();
  const double value = json.get<double>();
  if (value < 0 || value > kExactWholeMax) return std::nullopt;
  return static_cast<std::uint64_t>(value);
}

}  // namespace

void add_violation(const Node& node, std::string_view code, std::string detail) {
  auto& list = node.findings->violations;
  if (list.size() >= kViolationsMax) return;
  list.push_back({.file = node.findings->file,
                  .pointer = node.pointer,
                  .code = std::string(code),
                  .detail = std::move(detail)});
}

void add_violation(const Node& parent, std::string_view member, std::string_view code, std::string detail) {
  add_violation({nullptr, parent.pointer + '/' + pointer_step(member), parent.findings}, code,
                std::move(detail));
}

bool is_object_of(const Node& node, std::span<const std::string_view> known) {
  if (!node.json->is_object()) {
    add_wrong_type(node, "an object");
    return false;
  }
  for (const auto& [name, value] : node.json->items()) {
    if (node.findings->violations.size() >= kViolationsMax) break;  // or a million names would be compared
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    add_violation(node, name, "unknown_field", "is not a field here" + suggestion(name, known));
    take_as_meant(node, name, known);
  }
  return true;
}

bool is_object_of(const Node& node, std::initializer_list<std::string_view> known) {
  return is_object_of(node, std::span(known.begin(), known.size()));
}

bool is_object_of_at_most(const Node& node, std::size_t most) {
  if (!node.json->is_object()) {
    add_wrong_type(node, "an object");
    return false;
  }
  if (node.json->size() <= most) return true;
  add_violation(
      node, "too_many",
      "must have at most " + std::to_string(most) + " members, got " + std::to_string(node.json->size()));
  return false;
}

bool is_array_of(const Node& node, std::size_t least, std::size_t most) {
  if (!node.json->is_array()) {
    add_wrong_type(node, "an array");
    return false;
  }
  const std::size_t count = node.json->size();
  if (count >= least && count <= most) return true;
  const std::string expected =
      least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
  add_violation(node, "wrong_length", "must have " + expected + " elements, got " + std::to_string(count));
  return false;
}

std::optional<Node> member(const Node& object, std::string_view name) {
  const auto found = object.json->find(name);
  if (found != object.json->end())
    return Node{&*found, object.pointer + '/' + pointer_step(name), object.findings};
  const auto& misspelt = object.findings->misspelt;
  if (misspelt.empty()) return std::nullopt;
  const auto meant = misspelt.find(object.pointer + '/' + pointer_step(name));
  if (meant == misspelt.end()) return std::nullopt;
  return member(object, meant->second);
}

std::optional<Node> required(const Node& object, std::string_view name) {
  auto node = member(object, name);
  if (!node) add_violation(object, name, "missing", "is required");
  return node;
}

Node element(const Node& array, std::size_t index) {
  return {&(*array.json)[index], array.pointer + "/" + std::to_string(index), array.findings};
}

std::vector<std::pair<std::string, Node>> members(const Node& object) {
  std::vector<std::pair<std::string, Node>> list;
  for (const auto& [name, value] : object.json->items())
    list.emplace_back(name, Node{&value, object.pointer + '/' + pointer_step(name), object.findings});
  return list;
}

std::optional<double> number(const Node& node, const Range& range, std::string_view why) {
  if (!node.json->is_number()) {
    add_wrong_type(node, "a number");
    return std::nullopt;
  }
  const double value = node.json->get<double>();
  if (contains(range, value)) return value;
  add_violation(node, "out_of_range",
                "must be " + range_text(range) + std::string(why) + ", got " + node.json->dump());
  return std::nullopt;
}

std::optional<std::uint64_t> whole(const Node& node, std::uint64_t lowest, std::uint64_t highest,
                                   std::string_view why) {
  const bool fraction =
      node.json->is_number_float() && std::trunc(node.json->get<double>()) != node.json->get<double>();
  if (!node.json->is_number() || fraction) {
    add_wrong_type(node, "a whole number");
    return std::nullopt;
  }
  const auto value = as_whole(*node.json);
  if (value && *value >= lowest && *value <= highest) return value;
  add_violation(node, "out_of_range",
                "must be at least " + std::to_string(lowest) + " and at most " + std::to_string(highest) +
                    std::string(why) + ", got " + node.json->dump());
  return std::nullopt;
}

std::optional<bool> boolean(const Node& node) {
  if (node.json->is_boolean()) return node.json->get<bool>();
  add_wrong_type(node, "true or false");
  return std::nullopt;
}

bool is_printable(const Node& node, std::string_view name, std::size_t most_bytes) {
  if (name.size() > most_bytes) {
    add_violation(
        node, "bad_name",
        "must be at most " + std::to_string(most_bytes) + " bytes, got " + std::to_string(name.size()));
    return false;
  }
  if (std::any_of(name.begin(), name.end(), is_control)) {
    add_violation(node, "bad_name", "must not contain control characters");
    return false;
  }
  return true;
}

std::optional<std::string> text(const Node& node, std::size_t most_bytes) {
  if (!node.json->is_string()) {
    add_wrong_type(node, "a string");
    return std::nullopt;
  }
  const auto& value = node.json->get_ref<const std::string&>();
  if (!is_printable(node, value, most_bytes)) return std::nullopt;
  return value;
}

bool numbers(const Node& node, std::span<double> values, const Range& range) {
  if (!is_array_of(node, values.size(), values.size())) return false;
  bool all = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = number(element(node, i), range);
    all = all && value;
    take(value, values[i]);
  }
  return all;
}

std::optional<Vec3> vec3(const Node& node, const Range& range) {
  Vec3 values{};
  if (!numbers(node, values, range)) return std::nullopt;
  return values;
}

std::optional<Vec3> number_or_vec3(const Node& node, const Range& range) {
  if (node.json->is_array()) return vec3(node, range);
  if (!node.json->is_number()) {
    add_wrong_type(node, "a number or an array of 3 numbers");
    return std::nullopt;
  }
  const auto value = number(node, range);
  if (!value) return std::nullopt;
  return Vec3{*value, *value, *value};
}

std::optional<std::size_t> one_of(const Node& node, std::span<const std::string_view> names) {
  if (!node.json->is_string()) {
    add_wrong_type(node, "a string");
    return std::nullopt;
  }
  const auto& given = node.json->get_ref<const std::string&>();
  const auto found = std::find(names.begin(), names.end(), given);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  add_violation(node, "unknown_value", "is not one of the values here" + suggestion(given, names));
  return std::nullopt;
}

}  // namespace api
