// Errors as problem documents (RFC 9457). The one place that chooses the status of an error.
#pragma once

#include <string>

#include "api/result.h"
#include "server/http/message.h"

namespace server {

/// 422, 404, 409, 503, 507 or 500 by the error's fault. What went wrong inside is logged, not told.
HttpAnswer problem(const api::Error& error, std::string_view instance);

/// For what HTTP itself is about: 400, 405, 413, 415, 416, ...
HttpAnswer problem(int status, std::string_view detail, std::string_view instance);

/// The same with the places to fix.
HttpAnswer problem(int status, const api::Error& error, std::string_view instance);

/// 400 for a parameter of the query, which `errors` names.
HttpAnswer bad_parameter(std::string_view name, std::string_view code, std::string_view detail,
                         std::string_view instance);

/// "Not Found" for 404.
std::string_view title_of(int status);

}  // namespace server
