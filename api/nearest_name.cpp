#include "api/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace api {
namespace {
constexpr std::size_t kListedNames = 24;
}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::optional<std::string_view> nearest_name(std::string_view given, std::span<const std::string_view> names,
                                             std::size_t bytes_max) {
  if (given.size() > bytes_max) return std::nullopt;
  std::optional<std::string_view> nearest;
  std::size_t smallest = std::max<std::size_t>(2, given.size() / 3) + 1;
  for (const std::string_view name : names) {
    const std::size_t longer = std::max(given.size(), name.size());
    const std::size_t shorter = std::min(given.size(), name.size());
    if (name.size() > bytes_max || longer - shorter >= smallest) continue;  // so many letters at least
    const std::size_t distance = edit_distance(given, name);
    if (distance >= smallest || distance >= name.size()) continue;
    smallest = distance;
    nearest = name;
  }
  return nearest;
}

std::string suggestion(std::string_view given, std::span<const std::string_view> names) {
  if (const auto nearest = nearest_name(given, names))
    return "; did you mean \"" + std::string(*nearest) + "\"?";
  if (names.empty() || names.size() > kListedNames) return "";
  std::string text = names.size() == 1 ? "; expected " : "; expected one of ";
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += ", ";
    text.append(1, '"').append(names[i]).append(1, '"');
  }
  return text;
}

}  // namespace api
