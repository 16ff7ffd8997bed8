// JSON as text, for those who must read or write some of their own (the server's answers). Needs api_json.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "api/job_request.h"
#include "api/result.h"

namespace api {

using Json = nlohmann::ordered_json;  ///< for writing: members stay in the order they were given
using ParsedJson = nlohmann::json;    ///< for reading: finding a member among many is quick

/// What a stranger's document may hold.
struct JsonLimits {
  std::size_t bytes = kAnimationBytesMax;
  std::size_t depth = 64;          ///< brackets open at once
  std::size_t values = 2'000'000;  ///< numbers, strings, arrays, objects, ... together
};

/// Checked before anything is built from it: size, depth, UTF-8, syntax, repeated members. Syntax errors name
/// line and column (1-based, in bytes), repeated members their JSON pointer. Never throws.
Result<ParsedJson> parse_json(std::string_view bytes, std::string_view file, const JsonLimits& limits = {});

/// Compact text. Never throws: bytes that are not UTF-8 become U+FFFD, numbers that are not finite null.
std::string json_text(const Json& json);

/// [{"file", "pointer", "line", "column", "code", "detail"}], those that are known, at most kViolationsMax.
/// api/schemas/problem.schema.json#/$defs/error
Json errors_json(const std::vector<Violation>& violations);

/// The body of an answer of type application/problem+json (RFC 9457), api/schemas/problem.schema.json.
/// `title` is the same for every occurrence of a `status`; `instance` is the path of the request.
std::string problem_json(const Error& error, int status, std::string_view title,
                         std::string_view instance = {});

/// The refusal of a document, with a message that counts its violations.
Error refusal(std::string_view file, std::vector<Violation> violations);

}  // namespace api
