// Requests that a browser makes on behalf of somebody else's page.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.h"

namespace server {

/// Which Host headers are answered, with any port or none.
struct HostRules {
  bool this_machine_only = true;        ///< of numbers only 127.x.x.x and [::1]; otherwise any address
  std::vector<std::string> names = {};  ///< besides localhost
};

/// A page whose name was rebound to our address would otherwise read what it likes. For that it needs a name
/// of its own; an address in numbers leads nowhere but here.
bool answers_for(std::string_view host, const HostRules& rules);

/// A 421 where Host is none that we answer for. A 403 for a request that may change something and whose
/// Origin is not our own: no page but ours may submit, cancel or delete. A request without these headers is
/// no browser's.
std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request, const HostRules& rules);

}  // namespace server
