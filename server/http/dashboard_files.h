// The dashboard as it was built: pages and scripts for browsers, read once when the server starts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "api/result.h"

namespace server {

/// One file, and the same compressed where that was worth it when the dashboard was built.
struct DashboardFile {
  std::string content_type;
  std::string bytes;
  std::string gzip;    ///< empty: none
  std::string brotli;  ///< empty: none
  std::string sha256;  ///< of `bytes`, lower-case hexadecimal
};

/// By path below the dashboard's folder: "index.html", "assets/keylume.4F2A.js", "examples/garage/scene.obj".
using DashboardFiles = std::map<std::string, DashboardFile, std::less<>>;

struct DashboardLimits {
  std::size_t files = 500;             ///< the compressed ones included
  std::int64_t bytes = 64 << 20;       ///< of all of them, held in memory as long as the server runs
  std::size_t folders_within_max = 2;  ///< examples/garage/
};

/// Everything below `folder`. Later changes in the folder are not noticed: a page never meets scripts of
/// another build. Errors: invalid_request, naming what is wrong - no index.html, a kind of file that browsers
/// are not to get from us, too many, too large; not_found where there is no such folder.
api::Result<DashboardFiles> read_dashboard(const std::filesystem::path& folder,
                                           const DashboardLimits& limits = {});

/// What browsers are to take a file of this name for; empty: not one that a dashboard has.
std::string_view dashboard_content_type(std::string_view name);

}  // namespace server
