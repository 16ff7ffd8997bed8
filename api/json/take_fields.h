// Optional members of an object: one that is there and right replaces the value.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "api/json/reader.h"

namespace api {

template <class Enum, std::size_t n>
void take_named(const Node& object, std::string_view name, const std::array<Named<Enum>, n>& table,
                Enum& value) {
  if (const auto field = member(object, name)) take(one_of(*field, table), value);
}

template <class T>
void take_whole(const Node& object, std::string_view name, std::uint64_t lowest, std::uint64_t highest,
                T& value) {
  if (const auto field = member(object, name)) take(whole(*field, lowest, highest), value);
}

/// `value` is a double, or an optional of one.
template <class T>
void take_number(const Node& object, std::string_view name, const Range& range, T& value) {
  if (const auto field = member(object, name)) take(number(*field, range), value);
}

inline void take_boolean(const Node& object, std::string_view name, bool& value) {
  if (const auto field = member(object, name)) take(boolean(*field), value);
}

}  // namespace api
