// "Did you mean ...?"
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace api {

/// Letters to insert, remove or replace to get from `a` to `b` (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The name that `given` most likely means: the nearest by edit distance, if no more than a third of its
/// letters (but two at least) are wrong. The first of equals. Names over `bytes_max` are passed over, to
/// bound the work: strangers choose them.
std::optional<std::string_view> nearest_name(std::string_view given, std::span<const std::string_view> names,
                                             std::size_t bytes_max = 64);

/// `; did you mean "camera"?` where one is near, else `; expected one of "a", "b"`. At most 24 are listed.
std::string suggestion(std::string_view given, std::span<const std::string_view> names);

}  // namespace api
