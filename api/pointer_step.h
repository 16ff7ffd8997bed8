// JSON pointers.
#pragma once

#include <string>
#include <string_view>

namespace api {

/// `name` as one step of a JSON pointer (RFC 6901), without the '/' before it: '~' and '/' escaped.
std::string pointer_step(std::string_view name);

}  // namespace api
