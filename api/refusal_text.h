// One wording for every refusal, whichever part of the input it concerns.
#pragma once

#include <string>

#include "api/result.h"

namespace api {

/// "scene.obj is refused: 2 places to fix.": how every refusal with violations begins.
inline std::string refusal_text(const std::string& what, std::size_t violation_count) {
  return what + " is refused: " + (violation_count >= kViolationsMax ? "at least " : "") +
         std::to_string(violation_count) + (violation_count == 1 ? " place" : " places") + " to fix.";
}

}  // namespace api
