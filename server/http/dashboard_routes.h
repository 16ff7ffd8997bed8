// What browsers get: the dashboard's pages, its scripts, and examples to start from.
#pragma once

#include <array>
#include <string_view>

#include "server/http/dashboard_files.h"
#include "server/http/router.h"

namespace server {

/// The paths of its pages. All are the same document; its script shows the page that the address names. They
/// need no token: they hold nothing, and ask for one where the service does.
inline constexpr std::array<std::string_view, 6> kDashboardPages{"/",        "/new",    "/jobs/{job}",
                                                                 "/compare", "/system", "/login"};
/// The files beside it.
inline constexpr std::array<std::string_view, 3> kDashboardFiles{"/assets/{file}", "/examples/index.json",
                                                                 "/examples/{example}/{file}"};

/// Is a route of the dashboard?
bool is_dashboard(std::string_view pattern);

/// Without files (empty) the pages say how to get them.
void add_dashboard_routes(Router& router, DashboardFiles files);

}  // namespace server
