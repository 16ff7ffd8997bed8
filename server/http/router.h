// Which function answers which method and path.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.h"

namespace server {

/// Values of the {names} in a route's pattern.
using PathValues = std::map<std::string, std::string, std::less<>>;

using RouteHandler = std::function<HttpAnswer(const HttpRequest&, const PathValues&)>;

/// Takes a body that is too large to hold, as it comes in.
using UploadHandler = std::function<HttpAnswer(const HttpRequest&, const PathValues&, const ReadBody&)>;

/// A refusal that needs no byte of the body: wrong type, too large by its own word. None: let it come.
using EarlyRefusal = std::function<std::optional<HttpAnswer>(const HttpRequest&)>;

/// A refusal that comes before the route looks at anything else.
using RouteGuard = std::function<std::optional<HttpAnswer>(const HttpRequest&, const PathValues&)>;

struct Route {
  std::string method;
  std::string pattern;  ///< as in api/openapi.yaml: "/v1/jobs/{id}/frames/{f}"
  RouteHandler handler;
  UploadHandler upload = {};       ///< instead of `handler` where the request comes over a socket
  EarlyRefusal refuse_early = {};  ///< asked before `upload`, also for `Expect: 100-continue`
  std::size_t body_bytes_max = 0;  ///< of a body that does not stream; 0: the server's
};

struct FoundRoute {
  const Route* route = nullptr;  ///< none: no such route
  PathValues values;
};

/// Hand-written: no regular expression ever sees a stranger's path.
class Router {
 public:
  void add(std::string method, std::string pattern, RouteHandler handler);

  /// A route with a body that streams; the route may have been added with a handler before.
  void add_upload(std::string method, std::string pattern, UploadHandler upload, EarlyRefusal refuse_early);

  /// A route that was added, and takes bodies of at most `bytes_max`.
  void limit_body(std::string_view method, std::string_view pattern, std::size_t bytes_max);

  /// Of all routes with a {name}, also those that are added later: whatever such a route does, it does it
  /// only for whom the guard lets pass. Uploads are asked for with no such name.
  void guard(std::string name, RouteGuard guard);

  FoundRoute find(std::string_view method, std::string_view path) const;

  /// The route's answer; 404 where no pattern fits, 405 with `Allow` where one does under another method.
  /// HEAD is answered as GET; the body is left out when it is sent. Conditions and ranges are applied.
  HttpAnswer answer(const HttpRequest& request) const;

  const std::vector<Route>& routes() const { return routes_; }

 private:
  HttpAnswer answer_of(const Route& route, const HttpRequest& request, const PathValues& values) const;

  std::vector<Route> routes_;
  std::string guarded_name_;
  RouteGuard guard_;
};

}  // namespace server
