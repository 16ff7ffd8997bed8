// Who is let in, before anything else looks at a request.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/auth/rate_limiter.h"
#include "server/auth/token_folder.h"
#include "server/http/message.h"
#include "server/http/origin.h"
#include "server/http/proxy_list.h"
#include "server/http/router.h"

namespace server {

struct GateRules {
  HostRules hosts;                   ///< see refuse_stranger
  bool tokens_required = false;      ///< also before there has ever been one
  bool never_asks = false;           ///< whoever gets here may do what is here
  std::vector<std::string> proxies;  ///< see ProxyList; their X-Forwarded-* headers are believed
  RateRules rate;
};

/// Safe for use by several threads.
class Gate {
 public:
  using Clock = std::function<std::int64_t()>;

  /// `tokens` must outlive it. `clock`: milliseconds since 1970.
  Gate(TokenFolder& tokens, GateRules rules, Clock clock);

  /// The refusal, in this order: 421 and 403 for what a browser does on another's behalf, 401 without a token
  /// where one is asked for, 429 too often, 403 without the scope. None: come in; request.owner,
  /// request.address and request.sees_all are set. `more_headers`: for the answer, whichever it will be.
  std::optional<HttpAnswer> refuse(HttpRequest& request, const Route* route,
                                   std::vector<std::pair<std::string, std::string>>& more_headers);

 private:
  bool asks_for_tokens();
  std::optional<HttpAnswer> refuse_too_often(const HttpRequest& request, std::string_view who,
                                             std::vector<std::pair<std::string, std::string>>& more_headers);

  TokenFolder& tokens_;
  const GateRules rules_;
  const Clock clock_;
  ProxyList proxies_;
  RateLimiter limiter_;
  std::atomic<bool> tokens_seen_ = false;
};

/// The scope that a route asks for; none: everybody may. A path without a route asks for jobs:read, so that
/// strangers do not learn which paths there are.
std::optional<Scope> scope_of(const Route* route);

/// The token that a request brings by its header, or the name of a login by its cookie; none: neither.
struct BroughtToken {
  std::string text;
  bool by_cookie = false;
};
std::optional<BroughtToken> token_of(const HttpRequest& request);

/// The name of the login that a request's cookie brings.
std::optional<std::string> session_of(const HttpRequest& request);

/// The cookie of a login with that name; an empty one ends it. `seconds`: that it lasts.
std::string login_cookie(std::string_view session, bool over_tls, std::int64_t seconds);

}  // namespace server
