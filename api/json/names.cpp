#include "api/json/names.h"

#include <algorithm>
#include <array>

namespace api {
namespace {

/// Of radiosity_se.npy, the standard errors, and radiosity_other.npy, the lights of no group.
constexpr std::array<std::string_view, 2> kTakenGroupNames{"se", "other"};

/// 1 to 64 ASCII letters, digits, and signs among `signs`.
bool is_file_name(std::string_view name, std::string_view signs) {
  const auto plain = [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           signs.find(c) != std::string_view::npos;
  };
  return !name.empty() && name.size() <= kFileNameBytesMax && std::all_of(name.begin(), name.end(), plain);
}

}  // namespace

bool is_obj_name(const Node& node, std::string_view name) {
  if (!name.empty()) return is_printable(node, name, kNameBytesMax);
  add_violation(node, "bad_name", "must not have an empty name");
  return false;
}

bool is_folder_name(const Node& node, std::string_view name) {
  if (is_file_name(name, "_-.") && name[0] != '.' && name[0] != '-') return true;
  add_violation(
      node, "bad_name",
      "must be named with 1 to 64 letters, digits, '_', '-' or '.', the first a letter, digit or '_'");
  return false;
}

bool is_group_name(const Node& node, std::string_view name) {
  if (!is_file_name(name, "_-")) {
    add_violation(node, "bad_name", "must be named with 1 to 64 letters, digits, '_' or '-'");
    return false;
  }
  if (std::find(kTakenGroupNames.begin(), kTakenGroupNames.end(), name) == kTakenGroupNames.end())
    return true;
  add_violation(node, "bad_name", "must not be named \"se\" or \"other\": such files hold something else");
  return false;
}

}  // namespace api
