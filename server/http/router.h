// Which function answers which method and path.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.h"

namespace server {

/// Values of the {names} in a route's pattern.
using PathValues = std::map<std::string, std::string, std::less<>>;

using RouteHandler = std::function<HttpAnswer(const HttpRequest&, const PathValues&)>;

struct Route {
  std::string method;
  std::string pattern;  ///< as in api/openapi.yaml: "/v1/jobs/{id}/frames/{f}"
  RouteHandler handler;
};

/// Hand-written: no regular expression ever sees a stranger's path.
class Router {
 public:
  void add(std::string method, std::string pattern, RouteHandler handler);

  /// The route's answer; 404 where no pattern fits, 405 with `Allow` where one does under another method.
  /// HEAD is answered as GET; the body is left out when it is sent. Conditions and ranges are applied.
  HttpAnswer answer(const HttpRequest& request) const;

  const std::vector<Route>& routes() const { return routes_; }

 private:
  std::vector<Route> routes_;
};

}  // namespace server
