// What is checked of a JSON document before its meaning: limits, syntax, repeated members.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "api/json/json_text.h"

namespace api {

/// The document, or none where it cannot be read at all. Appends to `violations` why not, and also every
/// repeated member of a document that can be read (its last value is kept, so that the rest can be checked).
std::optional<ParsedJson> parse_strictly(std::string_view bytes, std::string_view file,
                                         const JsonLimits& limits, std::vector<Violation>& violations);

}  // namespace api
