// Reading what stands in paths, queries and headers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/text.h"

namespace server {

/// For a query: all but letters, digits, '-', '.', '_' and '~' as %XX.
std::string percent_encoded(std::string_view text);

/// Seconds that `Prefer: wait=N` asks for (RFC 7240), at most `most`; 0 where it does not.
std::int64_t wait_preference(std::string_view prefer, std::int64_t most);

}  // namespace server
