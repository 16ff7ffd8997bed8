// What a token looks like: kl_<prefix, 8>_<secret, 43>, all of [A-Za-z0-9_-], the prefix of [A-Za-z0-9].
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "api/result.h"

namespace server {

inline constexpr std::size_t kPrefixChars = 8;
inline constexpr std::size_t kSecretChars = 43;  // 32 random bytes as base64url

/// The kernel's randomness. Errors: internal where it has none.
api::Result<std::string> new_token_text();

/// The prefix of what has the form of a token: not secret, the name of its file. None: it is no token.
std::optional<std::string> prefix_of(std::string_view text);

/// In a time that depends on the lengths only, so that nobody learns by it how many characters fit.
bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace server
