#include "server/http/gate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/http/dashboard_routes.h"
#include "server/http/field_text.h"
#include "server/http/problem.h"

namespace server {
namespace {

constexpr std::string_view kCookie = "keylume_session";
// Browsers let nobody but this very host set or get a cookie of such a name; only over TLS.
constexpr std::string_view kCookieOverTls = "__Host-keylume_session";
constexpr std::string_view kChallenge = "Bearer realm=\"keylume\"";

struct RouteScope {
  std::string_view method;
  std::string_view pattern;
  std::optional<Scope> scope;
};

// What differs from the rule: reading asks for jobs:read, everything else for jobs:write.
constexpr std::array kScopeOfRoute{
    RouteScope{"GET", "/healthz", std::nullopt},
    RouteScope{"GET", "/readyz", std::nullopt},
    RouteScope{"GET", "/version", std::nullopt},
    RouteScope{"GET", "/openapi.json", std::nullopt},
    RouteScope{"GET", "/docs", std::nullopt},
    RouteScope{"GET", "/v1/limits", std::nullopt},
    RouteScope{"POST", "/v1/login", std::nullopt},
    RouteScope{"POST", "/v1/logout", std::nullopt},
    RouteScope{"GET", "/metrics", Scope::metrics_read},
    RouteScope{"POST", "/v1/queue/pause", Scope::queue_admin},
    RouteScope{"POST", "/v1/queue/resume", Scope::queue_admin},
    RouteScope{"POST", "/v1/jobs/{id}/patches/series", Scope::jobs_read},
};

std::string_view cookie_name(bool over_tls) {
  return over_tls ? kCookieOverTls : kCookie;
}

std::optional<std::string> cookie_of(const HttpRequest& request) {
  const auto header = request.header("Cookie");
  if (!header) return std::nullopt;
  std::string_view rest = *header;
  while (!rest.empty()) {
    const std::string_view pair = take_member(rest, ";");
    const std::size_t equals = pair.find('=');
    if (equals != pair.npos && pair.substr(0, equals) == cookie_name(request.over_tls))
      return std::string(pair.substr(equals + 1));
  }
  return std::nullopt;
}

HttpAnswer not_known(const HttpRequest& request, bool brought_one) {
  HttpAnswer answer =
      brought_one ? problem(401, "the token is not known, has expired or was revoked", request.path)
                  : problem(401, "a token is needed: send it as Authorization: Bearer kl_...", request.path);
  answer.headers.emplace_back("WWW-Authenticate",
                              std::string(kChallenge) + (brought_one ? ", error=\"invalid_token\"" : ""));
  return answer;
}

HttpAnswer scope_not_allowed(const HttpRequest& request, Scope scope) {
  HttpAnswer answer =
      problem(403, "the token '" + request.owner + "' has not the scope " + std::string(name_of(scope)),
              request.path);
  answer.headers.emplace_back("WWW-Authenticate", std::string(kChallenge) +
                                                      ", error=\"insufficient_scope\", scope=\"" +
                                                      std::string(name_of(scope)) + "\"");
  return answer;
}

}  // namespace

std::optional<Scope> scope_of(const Route* route) {
  if (!route) return Scope::jobs_read;
  for (const RouteScope& known : kScopeOfRoute)
    if (known.method == route->method && known.pattern == route->pattern) return known.scope;
  if (route->method == "GET" && is_dashboard(route->pattern)) return std::nullopt;
  return route->method == "GET" ? Scope::jobs_read : Scope::jobs_write;
}

std::optional<BroughtToken> token_of(const HttpRequest& request) {
  constexpr std::string_view kBearer = "Bearer ";
  const std::string header = request.header("Authorization").value_or("");
  // Other schemes are for others, such as a proxy that asks for a password of its own.
  if (same_ignoring_case(std::string_view(header).substr(0, kBearer.size()), kBearer))
    return BroughtToken{std::string(trimmed(std::string_view(header).substr(kBearer.size())))};
  if (auto cookie = cookie_of(request)) return BroughtToken{std::move(*cookie), true};
  return std::nullopt;
}

std::optional<std::string> session_of(const HttpRequest& request) {
  return cookie_of(request);
}

std::string login_cookie(std::string_view session, bool over_tls, std::int64_t seconds) {
  return std::string(cookie_name(over_tls)) + "=" + std::string(session) +
         "; Path=/; HttpOnly; SameSite=Strict; Max-Age=" + std::to_string(session.empty() ? 0 : seconds) +
         (over_tls ? "; Secure" : "");
}

Gate::Gate(TokenFolder& tokens, GateRules rules, Clock clock)
    : tokens_(tokens),
      rules_(std::move(rules)),
      clock_(std::move(clock)),
      proxies_(rules_.proxies),
      limiter_(rules_.rate) {}

bool Gate::asks_for_tokens() {
  if (rules_.never_asks) return false;
  if (rules_.tokens_required || tokens_seen_) return true;
  // From the first token on; revoking the last one must not open the door again.
  if (tokens_.exists()) tokens_seen_ = true;
  return tokens_seen_;
}

std::optional<HttpAnswer> Gate::refuse_too_often(
    const HttpRequest& request, std::string_view who,
    std::vector<std::pair<std::string, std::string>>& more_headers) {
  if (!limiter_.on()) return std::nullopt;
  const RateLimiter::Answer answer = limiter_.ask(who);
  const auto window =
      static_cast<std::size_t>(std::ceil(limiter_.rules().burst / limiter_.rules().per_second));
  more_headers.emplace_back(
      "RateLimit-Policy",
      "\"default\";q=" + std::to_string(static_cast<std::size_t>(limiter_.rules().burst)) +
          ";w=" + std::to_string(window));
  more_headers.emplace_back("RateLimit", "\"default\";r=" + std::to_string(answer.remaining) +
                                             ";t=" + std::to_string(answer.wait_seconds));
  if (answer.allowed) return std::nullopt;
  HttpAnswer refusal = problem(429, "too many requests; wait as long as Retry-After says", request.path);
  // Sooner, mostly, than a problem of this status says by itself.
  std::erase_if(refusal.headers, [](const auto& header) { return header.first == "Retry-After"; });
  refusal.headers.emplace_back("Retry-After", std::to_string(std::max<std::size_t>(answer.wait_seconds, 1)));
  return refusal;
}

std::optional<HttpAnswer> Gate::refuse(HttpRequest& request, const Route* route,
                                       std::vector<std::pair<std::string, std::string>>& more_headers) {
  if (auto stranger = refuse_stranger(request, rules_.hosts)) return stranger;
  request.over_tls = false;
  if (proxies_.has(request.address, request.header("X-Forwarded-Proto").has_value())) {
    request.over_tls = request.header("X-Forwarded-Proto") == "https";
    // The last entry is the proxy's own word; those before it came from the client.
    if (const auto forwarded = request.header("X-Forwarded-For"))
      request.address = trimmed(std::string_view(*forwarded).substr(forwarded->rfind(',') + 1));
  }
  const std::optional<Scope> wanted = scope_of(route);
  auto brought = token_of(request);
  const std::string session = brought && brought->by_cookie ? brought->text : "";
  if (!session.empty()) brought->text = tokens_.sessions().token_of(session, clock_()).value_or("");
  const auto token = brought ? tokens_.find(brought->text, clock_()) : std::nullopt;
  if (token) request.owner = token->name;
  if (auto often = refuse_too_often(request, token ? token->prefix : "from " + network_of(request.address),
                                    more_headers))
    return often;
  const bool asks = asks_for_tokens();
  request.sees_all = !asks || (token && token->scopes.has(Scope::queue_admin));
  request.still_allowed = [this, wanted, asks, sees_all = request.sees_all, session,
                           text = brought ? brought->text : std::string()] {
    if (!wanted || !asks_for_tokens()) return true;
    if (!session.empty() && !tokens_.sessions().token_of(session, clock_())) return false;
    const auto now = asks ? tokens_.find(text, clock_()) : std::nullopt;
    return now && now->scopes.has(*wanted) && now->scopes.has(Scope::queue_admin) == sees_all;
  };
  if (!wanted || !asks) return std::nullopt;
  if (!token) return not_known(request, brought.has_value());
  const bool writes = request.method != "GET" && request.method != "HEAD";
  // Browsers send the cookie with whatever page asks; that it is ours must be said, not just not denied.
  if (brought->by_cookie && writes && !request.header("Origin"))
    return problem(403, "a request with the login's cookie that changes something needs its Origin",
                   request.path);
  if (!token->scopes.has(*wanted)) return scope_not_allowed(request, *wanted);
  return std::nullopt;
}

}  // namespace server
