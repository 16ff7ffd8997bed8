// Where in a JSON text the values stand that somebody points to.
#pragma once

#include <span>
#include <string_view>

#include "api/result.h"

namespace api {

/// Gives those of `violations` that say where only by a pointer, in the file called `file`, the line and
/// column at which the value begins; of one that is not there, at which the innermost one around it begins.
/// `bytes`: that file. Of text that is no JSON only what comes before the first mistake is found. Defined in
/// api/json/.
void add_places(std::string_view bytes, std::string_view file, std::span<Violation> violations);

}  // namespace api
