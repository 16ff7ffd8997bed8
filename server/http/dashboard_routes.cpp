#include "server/http/dashboard_routes.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "server/artefacts/verify.h"
#include "server/http/problem.h"

namespace server {
namespace {

// Nothing from elsewhere, no inline script or style; pictures made in the page are blobs.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; media-src 'self' "
    "blob:; connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors "
    "'none'";

constexpr std::string_view kNotBuilt = R"(<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><title>Keylume</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="light dark"></head>
<body>
<h1>Keylume</h1>
<p>The service runs. Its dashboard was not built with it: that needs <code>nodejs</code> (18 or newer) and <code>npm</code>.</p>
<ol>
<li>Install them; on Debian and Ubuntu: <code>apt-get install nodejs npm</code></li>
<li>Build again: <code>server/run</code>, or <code>cmake --build</code> in the build folder</li>
<li>Start the service again. It takes the folder <code>dashboard</code> beside its program, or the one that <code>--dashboard DIR</code> names.</li>
</ol>
<p>Everything works without it: <a href="/docs">what the service answers</a>, with curl or any other client.</p>
</body>
</html>
)";

/// Does an Accept-Encoding list take this coding? "*" is no promise that it can be read.
bool takes_coding(std::string_view list, std::string_view coding) {
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    std::string_view item = list.substr(0, comma);
    list = comma == list.npos ? std::string_view() : list.substr(comma + 1);
    item.remove_prefix(std::min(item.find_first_not_of(" \t"), item.size()));
    const std::size_t end = item.find_first_of("; \t");
    if (item.substr(0, end) != coding) continue;
    const std::size_t weight = item.find("q=");
    // q=0, q=0.0, q=0.000: not wanted.
    return weight == item.npos || item.find_first_of("123456789", weight) != item.npos;
  }
  return false;
}

HttpAnswer file_answer(const HttpRequest& request, const DashboardFile& file) {
  HttpAnswer answer;
  answer.content_type = file.content_type;
  answer.etag = file.sha256;
  const std::string accepted = request.header("Accept-Encoding").value_or("");
  const auto send = [&](const std::string& bytes, std::string_view coding) {
    answer.body = bytes;
    answer.etag.append(1, '-').append(coding);
    answer.headers.emplace_back("Content-Encoding", coding);
  };
  if (!file.brotli.empty() && takes_coding(accepted, "br"))
    send(file.brotli, "br");
  else if (!file.gzip.empty() && takes_coding(accepted, "gzip"))
    send(file.gzip, "gzip");
  else
    answer.body = file.bytes;
  answer.headers.emplace_back("Vary", "Accept-Encoding");
  return answer;
}

HttpAnswer with_headers(HttpAnswer answer, std::string_view cache) {
  answer.headers.emplace_back("Cache-Control", cache);
  answer.headers.emplace_back("Content-Security-Policy", kPolicy);
  return answer;
}

HttpAnswer page(const HttpRequest& request, const DashboardFiles& files) {
  const auto index = files.find("index.html");
  // Asked for every time: its scripts' names change with every build.
  if (index != files.end()) return with_headers(file_answer(request, index->second), "no-cache");
  HttpAnswer answer;
  answer.content_type = "text/html; charset=utf-8";
  answer.body = kNotBuilt;
  static const std::string etag = sha256_of(kNotBuilt);
  answer.etag = etag;
  return with_headers(std::move(answer), "no-cache");
}

HttpAnswer file(const HttpRequest& request, const DashboardFiles& files) {
  const auto found = files.find(std::string_view(request.path).substr(1));
  if (found == files.end()) return problem(404, "the dashboard has no such file", request.path);
  // Names of assets hold a hash of their bytes; those of examples do not.
  const bool forever = found->first.starts_with("assets/");
  return with_headers(file_answer(request, found->second),
                      forever ? "public, max-age=31536000, immutable" : "no-cache");
}

}  // namespace

bool is_dashboard(std::string_view pattern) {
  return std::find(kDashboardPages.begin(), kDashboardPages.end(), pattern) != kDashboardPages.end() ||
         std::find(kDashboardFiles.begin(), kDashboardFiles.end(), pattern) != kDashboardFiles.end();
}

void add_dashboard_routes(Router& router, DashboardFiles files) {
  const auto shared = std::make_shared<const DashboardFiles>(std::move(files));
  for (const std::string_view pattern : kDashboardPages)
    router.add("GET", std::string(pattern),
               [shared](const HttpRequest& request, const PathValues&) { return page(request, *shared); });
  for (const std::string_view pattern : kDashboardFiles)
    router.add("GET", std::string(pattern),
               [shared](const HttpRequest& request, const PathValues&) { return file(request, *shared); });
}

}  // namespace server
