// Requests that a browser makes on behalf of somebody else's page.
#pragma once

#include <optional>
#include <string_view>

#include "server/http/message.h"

namespace server {

/// Does a Host header name this machine: localhost, 127.x.x.x or [::1], with any port or none?
bool names_this_machine(std::string_view host);

/// A 421 where `this_machine_only` (we listen on loopback) and Host names another machine: a page whose name
/// was rebound to our address would otherwise read what it likes. A 403 for a request that may change
/// something and whose Origin is not our own: no page but ours may submit, cancel or delete. A request
/// without these headers is no browser's.
std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request, bool this_machine_only);

}  // namespace server
