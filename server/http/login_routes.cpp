// Browsers cannot send a token with every picture and event stream: they get a cookie for it, with the name
// of their login.
#include "api/json/json_text.h"
#include "server/http/gate.h"
#include "server/http/problem.h"
#include "server/http/routes.h"

namespace server {
namespace {

constexpr std::size_t kBodyBytesMax = 4096;  // anybody may send one, so it is short

/// The body of a login; none: it is no such body.
std::optional<std::string> token_in(std::string_view body) {
  const auto json = api::parse_json(body, "body", {kBodyBytesMax, 4, 16});
  if (!json || !json->is_object() || json->size() != 1) return std::nullopt;
  const auto token = json->find("token");
  if (token == json->end() || !token->is_string()) return std::nullopt;
  return token->get<std::string>();
}

HttpAnswer with_cookie(std::string cookie) {
  HttpAnswer answer;
  answer.status = 204;
  answer.headers = {{"Set-Cookie", std::move(cookie)}, {"Cache-Control", "no-store"}};
  return answer;
}

/// POST /v1/login, operationId logIn.
HttpAnswer log_in(TokenFolder& tokens, const HttpRequest& request, std::int64_t now_ms) {
  const auto text = token_in(request.body);
  if (!text) {
    const std::string detail = "the body must be {\"token\": \"kl_...\"}";
    return problem(422, {api::Fault::invalid_request, detail, {{"body", "/token", 0, 0, "missing", detail}}},
                   request.path);
  }
  if (!tokens.find(*text, now_ms)) {
    HttpAnswer refused = problem(401, "the token is not known, has expired or was revoked", request.path);
    refused.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"keylume\", error=\"invalid_token\"");
    return refused;
  }
  const auto session = tokens.sessions().begin(*text, now_ms);
  if (!session) return problem(503, session.error(), request.path);
  return with_cookie(login_cookie(*session, request.over_tls, SessionRules().lasts_ms / 1000));
}

}  // namespace

void add_login_routes(Router& router, TokenFolder& tokens, std::function<std::int64_t()> clock) {
  router.add("POST", "/v1/login",
             [&tokens, clock = std::move(clock)](const HttpRequest& request, const PathValues&) {
               return log_in(tokens, request, clock());
             });
  router.limit_body("POST", "/v1/login", kBodyBytesMax);
  // operationId logOut. The token stays valid: whoever wants it gone revokes it.
  router.add("POST", "/v1/logout", [&tokens](const HttpRequest& request, const PathValues&) {
    if (const auto session = session_of(request)) tokens.sessions().end(*session);
    return with_cookie(login_cookie("", request.over_tls, 0));
  });
}

}  // namespace server
