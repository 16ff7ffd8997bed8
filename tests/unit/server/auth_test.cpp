// Tokens, scopes and rates: who is let in, and to what.
#include <sys/stat.h>

#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "server/auth/token_text.h"
#include "server/http/dashboard_routes.h"
#include "server/http/gate.h"
#include "server/http/ops_routes.h"
#include "server/http/routes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000;

using Headers = std::map<std::string, std::string>;

HttpRequest request_to(std::string method, std::string path, Headers headers = {}) {
  HttpRequest request{std::move(method), std::move(path), {}, {}};
  request.address = "192.0.2.1";
  request.header = [headers = std::move(headers)](std::string_view name) -> std::optional<std::string> {
    const auto found = headers.find(std::string(name));
    return found == headers.end() ? std::nullopt : std::optional(found->second);
  };
  return request;
}

Scopes scopes_of(std::string_view list) {
  return *parse_scopes(list);
}

class AuthTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    tokens_ = std::make_unique<TokenFolder>(temporary_.path() / "data");
    reader_ = std::move(*EventReader::open(folder_->database()));
    hub_ = std::make_unique<EventHub>(*reader_);
    add_job_routes(router_, *jobs_);
    add_result_routes(router_, *jobs_);
    add_event_routes(router_, *jobs_, *hub_);
    add_login_routes(router_, *tokens_, [] { return kNow; });
    add_ops_routes(router_, {*jobs_, *store_, *folder_, *hub_, http_metrics_, job_metrics_});
    add_limits_route(router_, {});
    add_service_routes(router_);
    add_dashboard_routes(router_, {});
    rules_.hosts.this_machine_only = false;
  }

  std::string make(std::string_view name, std::string_view scopes = "jobs:read,jobs:write",
                   std::optional<std::int64_t> expires_ms = std::nullopt) {
    auto text = tokens_->create(name, scopes_of(scopes), kNow, expires_ms);
    EXPECT_TRUE(text) << text.error().message;
    return text ? *text : "";
  }
  /// The status of the refusal; 0: let in.
  int refusal(HttpRequest request) {
    if (!gate_) gate_ = std::make_unique<Gate>(*tokens_, rules_, [] { return kNow; });
    const FoundRoute found = router_.find(request.method, request.path);
    more_.clear();
    answer_ = gate_->refuse(request, found.route, more_);
    seen_ = request;
    return answer_ ? answer_->status : 0;
  }
  int refusal_with(const std::string& token, const std::string& method, const std::string& path) {
    return refusal(request_to(method, path, {{"Authorization", "Bearer " + token}}));
  }
  std::string header_of_answer(std::string_view name) const {
    for (const auto& [key, value] : answer_->headers)
      if (key == name) return value;
    return "";
  }

  HttpMetrics http_metrics_;
  JobMetrics job_metrics_;
  Router router_;
  GateRules rules_;
  std::unique_ptr<TokenFolder> tokens_;
  std::unique_ptr<EventReader> reader_;
  std::unique_ptr<EventHub> hub_;
  std::unique_ptr<Gate> gate_;
  std::optional<HttpAnswer> answer_;
  HttpRequest seen_;
  std::vector<std::pair<std::string, std::string>> more_;
};

TEST_F(AuthTest, OnlyTheHashOfATokenIsKept) {
  const std::string text = make("render-farm");
  const auto file = temporary_.path() / "data/tokens" / (*prefix_of(text) + ".json");
  const std::string kept = read_text(file);
  EXPECT_EQ(kept.find(text.substr(12)), std::string::npos) << "the secret is in the file";
  EXPECT_NE(kept.find("render-farm"), std::string::npos);
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0077, 0u) << "others can read it";
}

TEST_F(AuthTest, ATokenIsFoundUntilItExpiresOrIsRevoked) {
  const std::string text = make("a"), expiring = make("b", "jobs:read", kNow + 1000);
  EXPECT_EQ(tokens_->find(text, kNow)->name, "a");
  EXPECT_TRUE(tokens_->find(expiring, kNow + 999));
  EXPECT_FALSE(tokens_->find(expiring, kNow + 1000));
  std::string other = text;
  other.back() = other.back() == 'A' ? 'E' : 'A';
  EXPECT_FALSE(tokens_->find(other, kNow)) << "same prefix, another secret";
  TokenFolder elsewhere(temporary_.path() / "data");  // as the command line does while a server runs
  ASSERT_TRUE(elsewhere.revoke("a"));
  EXPECT_FALSE(tokens_->find(text, kNow));
  EXPECT_EQ(elsewhere.revoke("a").error().fault, api::Fault::not_found);
}

TEST_F(AuthTest, NamesAreUniqueAndPlain) {
  make("a");
  EXPECT_EQ(tokens_->create("a", scopes_of("jobs:read"), kNow, {}).error().fault, api::Fault::wrong_state);
  for (const char* name : {"", "a b", "a/b", "a\n", "\xC3\xA4"})
    EXPECT_EQ(tokens_->create(name, scopes_of("jobs:read"), kNow, {}).error().fault,
              api::Fault::invalid_request);
  EXPECT_FALSE(parse_scopes("jobs:read,jobs:dance"));
  EXPECT_FALSE(parse_scopes(""));
  EXPECT_EQ(text_of(scopes_of("queue:admin,jobs:read")), "jobs:read,queue:admin");
}

TEST_F(AuthTest, ADamagedFileIsNoToken) {
  const std::string text = make("a", "jobs:read", kNow + 1000);
  const auto file = temporary_.path() / "data/tokens" / (*prefix_of(text) + ".json");
  const std::string kept = read_text(file);
  for (const auto& [what, by] :
       {std::pair{"\"expires_ms\"", "\"expired_ms\""}, {"jobs:read", "jobs:dance"}, {"{", "["}}) {
    std::string damaged = kept;
    damaged.replace(damaged.find(what), std::string(what).size(), by);
    write_text(file, damaged);
    EXPECT_FALSE(TokenFolder(temporary_.path() / "data").find(text, kNow)) << by;
  }
}

// Every route, every scope: reading asks for jobs:read, changing for jobs:write, with these exceptions.
TEST_F(AuthTest, EveryRouteAsksForItsScopeAndForNoOther) {
  const std::set<std::string> open{"GET /healthz", "GET /readyz",    "GET /version",    "GET /openapi.json",
                                   "GET /docs",    "POST /v1/login", "POST /v1/logout", "GET /v1/limits"};
  const std::map<std::string, Scope> special{{"GET /metrics", Scope::metrics_read},
                                             {"POST /v1/queue/pause", Scope::queue_admin},
                                             {"POST /v1/queue/resume", Scope::queue_admin},
                                             {"POST /v1/jobs/{id}/patches/series", Scope::jobs_read}};
  std::map<Scope, std::string> token_with;
  for (const Scope scope : kScopes)
    token_with[scope] = make("only-" + std::to_string(static_cast<int>(scope)), name_of(scope));
  ASSERT_GT(router_.routes().size(), 20u);
  for (const Route& route : router_.routes()) {
    const std::string key = route.method + " " + route.pattern;
    const bool everybody = open.contains(key) || is_dashboard(route.pattern);
    const auto exception = special.find(key);
    const Scope wanted = exception != special.end() ? exception->second
                         : route.method == "GET"    ? Scope::jobs_read
                                                    : Scope::jobs_write;
    EXPECT_EQ(refusal(request_to(route.method, route.pattern)), everybody ? 0 : 401) << key;
    for (const auto& [scope, token] : token_with)
      EXPECT_EQ(refusal_with(token, route.method, route.pattern), everybody || scope == wanted ? 0 : 403)
          << key << " with " << name_of(scope);
  }
}

TEST_F(AuthTest, ARefusalSaysWhatIsMissing) {
  const std::string reader = make("reader", "jobs:read");
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs")), 401);
  EXPECT_EQ(header_of_answer("WWW-Authenticate"), "Bearer realm=\"keylume\"");
  EXPECT_EQ(refusal_with("kl_wrong", "GET", "/v1/jobs"), 401);
  EXPECT_NE(header_of_answer("WWW-Authenticate").find("invalid_token"), std::string::npos);
  EXPECT_EQ(refusal_with(reader, "POST", "/v1/jobs"), 403);
  EXPECT_NE(header_of_answer("WWW-Authenticate").find("scope=\"jobs:write\""), std::string::npos);
  EXPECT_EQ(refusal(request_to("GET", "/v1/nowhere")), 401) << "strangers do not learn which paths there are";
  EXPECT_EQ(refusal_with(reader, "GET", "/v1/jobs"), 0);
  EXPECT_EQ(seen_.owner, "reader");
}

TEST_F(AuthTest, NobodyIsAskedBeforeThereIsATokenButForEverFromThenOn) {
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs")), 0);
  make("a");
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs")), 401);
  ASSERT_TRUE(tokens_->revoke("a"));
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs")), 401) << "revoking the last one opens no door";
  gate_.reset();
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs")), 401) << "nor does a restart";
}

TEST_F(AuthTest, ACookieWritesOnlyFromOurOwnPages) {
  const std::string token = make("a");
  const std::string cookie =
      "theme=dark; keylume_session=" + *tokens_->sessions().begin(token, kNow) + "; x=y";
  const Headers bare{{"Host", "localhost:8080"}, {"Cookie", cookie}};
  Headers ours = bare, theirs = bare;
  ours["Origin"] = "http://localhost:8080";
  theirs["Origin"] = "http://example.com";
  for (const char* method : {"POST", "DELETE", "PATCH", "PUT"}) {
    const std::string path = std::string(method) == "POST" ? "/v1/jobs" : "/v1/jobs/x";
    EXPECT_EQ(refusal(request_to(method, path, bare)), 403) << method;
    EXPECT_EQ(refusal(request_to(method, path, theirs)), 403) << method;
  }
  EXPECT_EQ(refusal(request_to("POST", "/v1/jobs", ours)), 0);
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", bare)), 0) << "reading needs none";
}

TEST_F(AuthTest, ACookieIsNoTokenAndEndsWithItsLoginOrItsToken) {
  const std::string token = make("a");
  const auto log_in = [&] {
    HttpRequest login = request_to("POST", "/v1/login");
    login.body = "{\"token\": \"" + token + "\"}";
    const std::string cookie = router_.answer(login).headers.at(0).second;
    EXPECT_EQ(cookie.find(token.substr(12)), std::string::npos) << "the token's secret stays here";
    return Headers{{"Host", "localhost:8080"}, {"Cookie", cookie.substr(0, cookie.find(';'))}};
  };
  const Headers first = log_in(), second = log_in();
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", first)), 0);
  const std::string name = first.at("Cookie").substr(first.at("Cookie").find('=') + 1);
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", {{"Authorization", "Bearer " + name}})), 401);
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", {{"Cookie", "keylume_session=" + token}})), 401);
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", {{"Cookie", "keylume_token=" + token}})), 401);
  EXPECT_EQ(router_.answer(request_to("POST", "/v1/logout", first)).status, 204);
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", first)), 401);
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", second)), 0) << "another login goes on";
  ASSERT_TRUE(tokens_->revoke("a"));
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", second)), 401);
}

TEST_F(AuthTest, TheLoginGivesACookieThatScriptsCannotRead) {
  const std::string token = make("a");
  HttpRequest login = request_to("POST", "/v1/login");
  login.body = "{\"token\": \"" + token + "\"}";
  const HttpAnswer answer = router_.answer(login);
  EXPECT_EQ(answer.status, 204);
  const std::string cookie = answer.headers.at(0).second;
  for (const char* part : {"HttpOnly", "SameSite=Strict", "Path=/", "Max-Age="})
    EXPECT_NE(cookie.find(part), std::string::npos) << cookie;
  EXPECT_EQ(cookie.find("Secure"), std::string::npos);
  login.over_tls = true;
  const std::string over_tls = router_.answer(login).headers.at(0).second;
  EXPECT_NE(over_tls.find("; Secure"), std::string::npos);
  EXPECT_TRUE(over_tls.starts_with("__Host-keylume_session=")) << over_tls;
  for (const char* body : {"", "{}", "[]", "{\"token\": 1}", "{\"token\": \"a\", \"more\": 1}"}) {
    login.body = body;
    EXPECT_EQ(router_.answer(login).status, 422) << body;
  }
  login.body = "{\"token\": \"kl_wrong\"}";
  EXPECT_EQ(router_.answer(login).status, 401);
  EXPECT_NE(router_.answer(request_to("POST", "/v1/logout")).headers.at(0).second.find("Max-Age=0"),
            std::string::npos);
}

TEST_F(AuthTest, ForwardedHeadersAreBelievedOfOurProxyOnly) {
  rules_.proxies = {"192.0.2.1"};
  const Headers forwarded{{"X-Forwarded-For", "198.51.100.9, 203.0.113.7"}, {"X-Forwarded-Proto", "https"}};
  refusal(request_to("GET", "/healthz", forwarded));
  EXPECT_EQ(seen_.address, "203.0.113.7") << "what the proxy saw, not what the client says";
  EXPECT_TRUE(seen_.over_tls);
  HttpRequest other = request_to("GET", "/healthz", forwarded);
  other.address = "192.0.2.2";
  refusal(std::move(other));
  EXPECT_EQ(seen_.address, "192.0.2.2");
  EXPECT_FALSE(seen_.over_tls);
}

TEST_F(AuthTest, AnIPv6NetworkSharesItsRequests) {
  rules_.rate = {1, 2};
  make("a");
  for (const auto& [last, status] : {std::pair{"1", 401}, {"2", 401}, {"3", 429}}) {
    HttpRequest request = request_to("GET", "/v1/jobs");
    request.address = std::string("2001:db8::") + last;
    EXPECT_EQ(refusal(std::move(request)), status) << last;
  }
}

TEST_F(AuthTest, TheSchemeHasNoCaseAndOthersAreForOthers) {
  const std::string token = make("a");
  for (const char* scheme : {"Bearer ", "bearer ", "BEARER  "})
    EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", {{"Authorization", scheme + token}})), 0) << scheme;
  const Headers behind_proxy{{"Authorization", "Basic dXNlcjpwYXNz"},
                             {"Cookie", "keylume_session=" + *tokens_->sessions().begin(token, kNow)}};
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", behind_proxy)), 0) << "a proxy's password is not for us";
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs", {{"Authorization", "Basic dXNlcjpwYXNz"}})), 401);
}

TEST_F(AuthTest, AFolderThatHasNeverHeldATokenIsNone) {
  // As a crash leaves it at any moment of the making.
  const auto look = [&](const std::string& fresh) -> api::Result<std::string> {
    EXPECT_FALSE(tokens_->exists());
    return fresh;
  };
  ASSERT_TRUE(tokens_->create("first", scopes_of("jobs:read"), kNow, {}, false, look));
  EXPECT_TRUE(tokens_->exists());
  ASSERT_TRUE(tokens_->revoke("first"));
  const auto refuse = [](const std::string&) -> api::Result<std::string> {
    return api::Error{api::Fault::disk_full, "no room"};
  };
  EXPECT_FALSE(tokens_->create("second", scopes_of("jobs:read"), kNow, {}, false, refuse));
  EXPECT_TRUE(tokens_->exists()) << "there has been one";
}

TEST_F(AuthTest, ATokenIsHandedOverBeforeItIsKept) {
  const auto tokens = temporary_.path() / "data/tokens";
  const auto count = [&] {
    return std::distance(std::filesystem::directory_iterator(tokens), std::filesystem::directory_iterator());
  };
  make("first");
  std::string handed;
  const auto text =
      tokens_->create("a", scopes_of("jobs:read"), kNow, {}, false, [&](const std::string& fresh) {
        EXPECT_EQ(count(), 1) << "a crash now leaves no token that nobody knows";
        handed = fresh;
        return api::Result<std::string>(fresh);
      });
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, handed);
  EXPECT_TRUE(tokens_->find(handed, kNow));
  const auto refuse = [](const std::string&) {
    return api::Result<std::string>(api::Error{api::Fault::disk_full, "no room"});
  };
  EXPECT_FALSE(tokens_->create("b", scopes_of("jobs:read"), kNow, {}, false, refuse));
  EXPECT_EQ(count(), 2);
}

TEST_F(AuthTest, OfTokensMadeAtOnceOneHasTheName) {
  std::atomic<int> made = 0;
  std::vector<std::thread> makers;
  for (int i = 0; i < 8; ++i)
    makers.emplace_back([&] {
      TokenFolder own(temporary_.path() / "data");  // as eight command lines
      if (own.create("same", scopes_of("jobs:read"), kNow, {})) ++made;
    });
  for (std::thread& maker : makers) maker.join();
  EXPECT_EQ(made, 1);
  EXPECT_EQ(tokens_->list()->size(), 1u);
}

TEST_F(AuthTest, WhoAsksTooOftenHearsWhenToComeBack) {
  rules_.rate = {1, 2};
  const std::string token = make("a");
  EXPECT_EQ(refusal_with(token, "GET", "/v1/jobs"), 0);
  ASSERT_EQ(more_.size(), 2u);
  EXPECT_EQ(more_[0].second, "\"default\";q=2;w=2");
  EXPECT_EQ(refusal_with(token, "GET", "/v1/jobs"), 0);
  EXPECT_EQ(refusal_with(token, "GET", "/v1/jobs"), 429);
  EXPECT_EQ(header_of_answer("Retry-After"), "1");
  EXPECT_EQ(refusal_with(make("b"), "GET", "/v1/jobs"), 0) << "another token from the same address";
  for (int i = 0; i < 2; ++i) EXPECT_EQ(refusal_with("kl_guess", "GET", "/v1/jobs"), 401);
  EXPECT_EQ(refusal_with("kl_guess", "GET", "/v1/jobs"), 429) << "guessing is slow";
}

TEST_F(AuthTest, TokensOfOneNameShareItAndGoTogetherOrOneByOne) {
  const std::string first = make("anna");
  EXPECT_EQ(tokens_->create("anna", scopes_of("jobs:read"), kNow, std::nullopt).error().fault,
            api::Fault::wrong_state);
  const auto second = tokens_->create("anna", scopes_of("jobs:read"), kNow, std::nullopt, true);
  ASSERT_TRUE(second);
  EXPECT_EQ(tokens_->find(*second, kNow)->name, tokens_->find(first, kNow)->name);
  ASSERT_TRUE(tokens_->revoke(*prefix_of(first)));
  EXPECT_FALSE(tokens_->find(first, kNow));
  EXPECT_TRUE(tokens_->find(*second, kNow));
  ASSERT_TRUE(tokens_->create("anna", scopes_of("jobs:read"), kNow, std::nullopt, true));
  ASSERT_TRUE(tokens_->revoke("anna"));
  EXPECT_TRUE(tokens_->list()->empty());
}

TEST_F(AuthTest, WhoMaySteerTheQueueSeesAllAndSoDoesEverybodyBeforeTheFirstToken) {
  EXPECT_EQ(refusal(request_to("GET", "/v1/jobs")), 0);
  EXPECT_TRUE(seen_.sees_all);
  const std::string anna = make("anna"), root = make("root", "jobs:read,queue:admin");
  EXPECT_EQ(refusal_with(anna, "GET", "/v1/jobs"), 0);
  EXPECT_FALSE(seen_.sees_all);
  EXPECT_EQ(seen_.owner, "anna");
  EXPECT_EQ(refusal_with(root, "GET", "/v1/jobs"), 0);
  EXPECT_TRUE(seen_.sees_all);
  EXPECT_EQ(refusal(request_to("GET", "/healthz")), 0);
  EXPECT_FALSE(seen_.sees_all) << "without a token";
}

TEST_F(AuthTest, WhatTakesLongCanAskWhetherItIsStillAllowed) {
  EXPECT_EQ(refusal(request_to("GET", "/v1/events", {})), 0);
  const auto nobody = seen_.still_allowed;
  EXPECT_TRUE(nobody());
  const std::string anna = make("anna"), admin = make("admin", "jobs:read,queue:admin");
  EXPECT_FALSE(nobody()) << "there is a token now";
  EXPECT_EQ(refusal_with(anna, "GET", "/v1/events"), 0);
  const auto with_token = seen_.still_allowed;
  EXPECT_TRUE(with_token());
  EXPECT_EQ(refusal_with(admin, "GET", "/v1/events"), 0);
  const auto with_other = seen_.still_allowed;
  ASSERT_TRUE(tokens_->revoke("anna"));
  EXPECT_FALSE(with_token());
  EXPECT_TRUE(with_other());
}

}  // namespace
}  // namespace server
