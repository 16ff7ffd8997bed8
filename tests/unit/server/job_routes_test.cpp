// Jobs and the queue over HTTP, without a socket.
#include <map>

#include "api/json/json_text.h"
#include "server/http/parameters.h"
#include "server/http/routes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::JobState;

class JobRoutes : public ServiceTest {
 protected:
  HttpAnswer ask(const std::string& method, const std::string& path, const std::string& body = "",
                 std::map<std::string, std::string> headers = {}) {
    Router router;
    add_job_routes(router, *jobs_);
    HttpRequest request;
    request.method = method;
    request.path = path.substr(0, path.find('?'));
    if (const std::size_t mark = path.find('?'); mark != path.npos) {
      std::string_view rest = std::string_view(path).substr(mark + 1);
      while (!rest.empty()) {
        const std::string_view pair = rest.substr(0, rest.find('&'));
        rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
        request.query.emplace_back(pair.substr(0, pair.find('=')), pair.substr(pair.find('=') + 1));
      }
    }
    request.body = body;
    request.header = [headers](std::string_view name) -> std::optional<std::string> {
      const auto found = headers.find(std::string(name));
      return found == headers.end() ? std::nullopt : std::optional(found->second);
    };
    return router.answer(request);
  }
  static api::ParsedJson json_of(const HttpAnswer& answer) {
    const auto json = api::parse_json(answer.body, "answer");
    EXPECT_TRUE(json) << answer.body;
    return json ? *json : api::ParsedJson();
  }
  static std::string header_of(const HttpAnswer& answer, std::string_view name) {
    for (const auto& [key, value] : answer.headers)
      if (key == name) return value;
    return "";
  }
};

TEST_F(JobRoutes, AJobIsPausedResumedCanceledAndRetried) {
  const std::string path = "/v1/jobs/" + submit().id;
  const auto state_after = [&](const std::string& wish) {
    const HttpAnswer answer = ask("POST", path + "/" + wish);
    EXPECT_EQ(answer.status, 202) << answer.body;
    return json_of(answer).at("state").get<std::string>();
  };
  EXPECT_EQ(state_after("pause"), "paused");
  EXPECT_EQ(json_of(ask("GET", path)).at("links").at("resume"), path + "/resume");
  EXPECT_EQ(state_after("resume"), "queued");
  EXPECT_EQ(state_after("cancel"), "canceled");
  EXPECT_EQ(json_of(ask("GET", path)).at("links").at("retry"), path + "/retry");
  EXPECT_EQ(ask("POST", path + "/pause").status, 409);
  EXPECT_EQ(state_after("retry?from=start"), "queued");
  EXPECT_EQ(ask("POST", path + "/retry?from=nowhere").status, 400);
  EXPECT_EQ(ask("POST", "/v1/jobs/nobody/pause").status, 404);
}

TEST_F(JobRoutes, APatchChangesWhatItNamesAndHoldsAgainstIfMatch) {
  const std::string path = "/v1/jobs/" + submit().id;
  const HttpAnswer before = ask("GET", path);
  const std::string etag = '"' + before.etag + '"';
  EXPECT_EQ(before.etag, "1-1") << "version and place in the queue";
  const HttpAnswer changed =
      ask("PATCH", path, R"({"priority": 7, "labels": {"a": "b"}, "deadline": "2030-01-01T00:00:00Z"})",
          {{"If-Match", etag}});
  ASSERT_EQ(changed.status, 200) << changed.body;
  EXPECT_EQ(json_of(changed).at("priority"), 7);
  EXPECT_EQ(json_of(changed).at("deadline"), "2030-01-01T00:00:00.000Z");
  EXPECT_EQ(json_of(changed).at("version"), 2);
  EXPECT_EQ(ask("PATCH", path, R"({"priority": 8})", {{"If-Match", etag}}).status, 412);
  for (const char* good : {"\"2\"", "\"1\", \"2\"", "*", "\"2-5\""}) {
    const std::string version = std::to_string(json_of(ask("GET", path)).at("version").get<int>());
    std::string match = good;
    if (const std::size_t at = match.find('2'); at != match.npos) match.replace(at, 1, version);
    EXPECT_EQ(ask("PATCH", path, R"({"pinned": true})", {{"If-Match", match}}).status, 200) << match;
  }
  for (const char* bad : {"", "2", "W/\"2\"", "\"\"", "\"x\""})
    EXPECT_EQ(ask("PATCH", path, R"({"pinned": true})", {{"If-Match", bad}}).status, 412) << bad;
}

TEST_F(JobRoutes, APatchThatIsWrongNamesThePlaces) {
  const std::string path = "/v1/jobs/" + submit().id;
  const HttpAnswer refused = ask("PATCH", path, R"({"priority": "high", "colour": 1})");
  EXPECT_EQ(refused.status, 422);
  const api::ParsedJson errors = json_of(refused).at("errors");
  ASSERT_EQ(errors.size(), 2u);
  for (const auto& error : errors)
    EXPECT_TRUE(error.at("pointer") == "/priority" || error.at("pointer") == "/colour");
  EXPECT_EQ(ask("PATCH", path, "").status, 422);
  EXPECT_EQ(ask("PATCH", "/v1/jobs/nobody", "{}").status, 404);
  EXPECT_EQ(ask("PATCH", "/v1/jobs/nobody", "{}", {{"If-Match", "*"}}).status, 404);
}

TEST_F(JobRoutes, AnUnchangedJobIs304AndItsPlaceInTheQueueIsAChange) {
  const Job first = submit();
  const std::string path = "/v1/jobs/" + submit().id;
  const HttpAnswer answer = ask("GET", path);
  EXPECT_EQ(json_of(answer).at("queue_position"), 2);
  const std::string etag = '"' + answer.etag + '"';
  EXPECT_EQ(ask("GET", path, "", {{"If-None-Match", etag}}).status, 304);
  ASSERT_TRUE(jobs_->cancel(first.id));
  const HttpAnswer moved = ask("GET", path, "", {{"If-None-Match", etag}});
  EXPECT_EQ(moved.status, 200);
  EXPECT_EQ(json_of(moved).at("queue_position"), 1);
}

TEST_F(JobRoutes, ListsTellWhereTheNextPageIsAndKeepTheFilters) {
  for (int i = 0; i < 3; ++i) {
    Upload upload = make_upload();
    upload.options = R"({"labels": {"project": "a b"}})";
    ASSERT_TRUE(jobs_->submit(upload));
  }
  const HttpAnswer page = ask("GET", "/v1/jobs?limit=2&label=project:a b&state=queued");
  ASSERT_EQ(page.status, 200) << page.body;
  const std::string cursor = json_of(page).at("next_cursor");
  EXPECT_EQ(header_of(page, "Link"),
            "</v1/jobs?cursor=" + cursor + "&limit=2&label=project%3Aa%20b&state=queued>; rel=\"next\"");
  const HttpAnswer last = ask("GET", "/v1/jobs?limit=2&label=project:a b&cursor=" + cursor);
  EXPECT_EQ(json_of(last).at("jobs").size(), 1u);
  EXPECT_EQ(header_of(last, "Link"), "");
  for (const char* bad : {"limit=0", "limit=201", "limit=x", "cursor=0", "cursor=x", "state=asleep",
                          "label=", "label=a b", "label=:x"})
    EXPECT_EQ(ask("GET", std::string("/v1/jobs?") + bad).status, 400) << bad;
  std::string many = "/v1/jobs?label=a";
  for (int i = 0; i < 8; ++i) many += "&label=a";
  EXPECT_EQ(ask("GET", many).status, 400);
}

TEST_F(JobRoutes, ABatchActsOnEveryJobAndTellsWhatBecameOfEach) {
  const std::string first = submit().id;
  const std::string second = submit().id;
  const HttpAnswer canceled =
      ask("POST", "/v1/jobs/batch", R"({"ids": [")" + first + R"(", "nobody"], "action": "cancel"})");
  ASSERT_EQ(canceled.status, 200) << canceled.body;
  const api::ParsedJson results = json_of(canceled).at("results");
  EXPECT_EQ(results.at(0).at("state"), "canceled");
  EXPECT_EQ(results.at(1).at("status"), 404);
  EXPECT_NE(results.at(1).at("detail"), "");
  const HttpAnswer removed = ask("POST", "/v1/jobs/batch",
                                 R"({"ids": [")" + first + R"(", ")" + second + R"("], "action": "delete"})");
  EXPECT_EQ(json_of(removed).at("results").at(0).at("status"), 204);
  EXPECT_EQ(json_of(removed).at("results").at(1).at("status"), 409) << "it is queued";
  EXPECT_EQ(ask("POST", "/v1/jobs/batch", R"({"ids": [], "action": "cancel"})").status, 422);
}

TEST_F(JobRoutes, TheQueueIsPausedWithAReasonAndResumed) {
  submit();
  const HttpAnswer paused = ask("POST", "/v1/queue/pause", R"({"reason": "maintenance"})");
  ASSERT_EQ(paused.status, 200) << paused.body;
  EXPECT_EQ(json_of(paused).at("paused"), true);
  EXPECT_EQ(json_of(paused).at("reason"), "maintenance");
  EXPECT_EQ(json_of(paused).at("jobs").at("queued"), 1);
  EXPECT_EQ(json_of(ask("POST", "/v1/queue/pause")).at("reason"), "on request");
  EXPECT_EQ(ask("POST", "/v1/queue/pause", R"({"raeson": ""})").status, 422);
  EXPECT_EQ(ask("POST", "/v1/queue/pause", "no json").status, 422);
  const api::ParsedJson resumed = json_of(ask("POST", "/v1/queue/resume"));
  EXPECT_EQ(resumed.at("paused"), false);
  EXPECT_TRUE(resumed.at("reason").is_null());
  EXPECT_EQ(json_of(ask("GET", "/v1/queue")).at("jobs").size(), api::kJobStates.size());
}

TEST_F(JobRoutes, ADryRunTellsWhatWouldBeDeleted) {
  const Job made = submit();
  const std::string path = "/v1/jobs/" + made.id;
  EXPECT_EQ(ask("DELETE", path + "?dry_run=true").status, 409);
  ASSERT_TRUE(jobs_->cancel(made.id));
  const HttpAnswer told = ask("DELETE", path + "?dry_run=true");
  ASSERT_EQ(told.status, 200) << told.body;
  EXPECT_EQ(json_of(told).at("files"), 2);
  EXPECT_EQ(ask("DELETE", path + "?dry_run=maybe").status, 400);
  EXPECT_EQ(ask("GET", path).status, 200);
  EXPECT_EQ(ask("DELETE", path + "?dry_run=false").status, 204);
  EXPECT_EQ(ask("GET", path).status, 404);
}

TEST(Parameters, PreferenceToWaitIsReadAndCapped) {
  EXPECT_EQ(wait_preference("wait=5", 60), 5);
  EXPECT_EQ(wait_preference("respond-async, wait=10", 60), 10);
  EXPECT_EQ(wait_preference("wait=500", 60), 60);
  for (const char* none : {"", "respond-async", "wait", "wait=", "wait=-1", "wait=x", "await=5"})
    EXPECT_EQ(wait_preference(none, 60), 0) << none;
}

}  // namespace
}  // namespace server
