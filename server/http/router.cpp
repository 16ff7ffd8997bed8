#include "server/http/router.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "server/artefacts/verify.h"
#include "server/http/conditions.h"
#include "server/http/problem.h"

namespace server {
namespace {

std::string_view take_segment(std::string_view& path) {
  const std::size_t slash = path.find('/');
  const std::string_view segment = path.substr(0, slash);
  path = slash == path.npos ? std::string_view() : path.substr(slash + 1);
  return segment;
}

std::optional<PathValues> match(std::string_view pattern, std::string_view path) {
  PathValues values;
  while (!pattern.empty() && !path.empty()) {
    const bool more_of_pattern = pattern.find('/') != pattern.npos;
    if (more_of_pattern != (path.find('/') != path.npos)) return std::nullopt;
    const std::string_view wanted = take_segment(pattern);
    const std::string_view given = take_segment(path);
    if (wanted.starts_with('{')) {
      const std::size_t close = wanted.find('}');
      const std::string_view ending = wanted.substr(close + 1);  // {series}.npy
      if (given.size() <= ending.size() || !given.ends_with(ending)) return std::nullopt;
      values.emplace(wanted.substr(1, close - 1), given.substr(0, given.size() - ending.size()));
    } else if (wanted != given) {
      return std::nullopt;
    }
  }
  if (!pattern.empty() || !path.empty()) return std::nullopt;
  return values;
}

/// Clients poll jobs: with a tag of its bytes, an answer that has not changed costs them a 304.
void name_what_may_be_polled(HttpAnswer& answer) {
  if (answer.status == 200 && answer.etag.empty() && answer.content_type == "application/json" &&
      !answer.body.empty())
    answer.etag = sha256_of(answer.body);
}

HttpAnswer method_not_allowed(const HttpRequest& request, const std::set<std::string>& methods) {
  std::string allow;
  for (const std::string& method : methods) allow += (allow.empty() ? "" : ", ") + method;
  HttpAnswer answer = problem(405, request.method + " is not possible here, only " + allow, request.path);
  answer.headers.emplace_back("Allow", allow);
  return answer;
}

HttpAnswer nothing_here(const HttpRequest& request, bool known_without_slash) {
  const std::string detail =
      known_without_slash ? "there is nothing at this path; there is without the slash at its end"
                          : "there is nothing at this path; GET /openapi.json says which paths there are";
  return problem(404, detail, request.path);
}

}  // namespace

void Router::add(std::string method, std::string pattern, RouteHandler handler) {
  routes_.push_back({std::move(method), std::move(pattern), std::move(handler)});
}

void Router::add_upload(std::string method, std::string pattern, UploadHandler upload,
                        EarlyRefusal refuse_early) {
  auto route = std::find_if(routes_.begin(), routes_.end(), [&](const Route& known) {
    return known.method == method && known.pattern == pattern;
  });
  if (route == routes_.end()) {
    const auto no_body = [](const HttpRequest& request, const PathValues&) {
      return problem(411, "a body is expected here", request.path);
    };
    route = routes_.insert(routes_.end(), {std::move(method), std::move(pattern), no_body});
  }
  route->upload = std::move(upload);
  route->refuse_early = std::move(refuse_early);
}

void Router::limit_body(std::string_view method, std::string_view pattern, std::size_t bytes_max) {
  for (Route& route : routes_)
    if (route.method == method && route.pattern == pattern) route.body_bytes_max = bytes_max;
}

void Router::guard(std::string name, RouteGuard guard) {
  guarded_name_ = std::move(name);
  guard_ = std::move(guard);
}

HttpAnswer Router::answer_of(const Route& route, const HttpRequest& request, const PathValues& values) const {
  if (guard_ && values.contains(guarded_name_))
    if (auto refused = guard_(request, values)) return *refused;
  HttpAnswer answer = route.handler(request, values);
  if (route.method == "GET") name_what_may_be_polled(answer);
  apply_conditions(request, answer);
  return answer;
}

FoundRoute Router::find(std::string_view method, std::string_view path) const {
  if (method == "HEAD") method = "GET";
  for (const Route& route : routes_)
    if (route.method == method)
      if (auto values = match(route.pattern, path)) return {&route, std::move(*values)};
  return {};
}

HttpAnswer Router::answer(const HttpRequest& request) const {
  const std::string_view method = request.method == "HEAD" ? "GET" : std::string_view(request.method);
  std::set<std::string> other_methods;
  for (const Route& route : routes_) {
    const auto values = match(route.pattern, request.path);
    if (!values) continue;
    if (route.method == method) return answer_of(route, request, *values);
    other_methods.insert(route.method);
    if (route.method == "GET") other_methods.insert("HEAD");
  }
  if (!other_methods.empty()) return method_not_allowed(request, other_methods);
  std::string_view shorter = request.path;
  if (shorter.ends_with('/')) shorter.remove_suffix(1);
  const bool known = std::any_of(routes_.begin(), routes_.end(),
                                 [&](const Route& route) { return match(route.pattern, shorter); });
  return nothing_here(request, known);
}

}  // namespace server
