// If-None-Match, Range and If-Range (RFC 9110, sections 13 and 14).
#pragma once

#include <optional>
#include <string_view>

#include "server/http/message.h"

namespace server {

/// Turns a whole 200 answer into the 304, 206 or 416 that the request asks for. One range is answered;
/// several at once, other units than bytes, and what cannot be read get the whole, as the RFC allows.
void apply_conditions(const HttpRequest& request, HttpAnswer& answer);

/// Does an If-None-Match or If-Match list name `etag` (without quotes)?
bool names_etag(std::string_view list, std::string_view etag);

}  // namespace server
