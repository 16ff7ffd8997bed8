// Jobs belong to their owners: to others they are as if they did not exist.
#include <algorithm>

#include "api/json/json_text.h"
#include "server/http/ops_routes.h"
#include "server/http/routes.h"
#include "server/workers/view_service.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

const std::string kUnknown = "job_00000000000000000000000000";

HttpRequest request_to(const std::string& method, const std::string& path, const Viewer& viewer) {
  HttpRequest request{method, path, {}, {}};
  request.header = [](std::string_view) { return std::optional<std::string>(); };
  request.owner = viewer.owner;
  request.sees_all = viewer.sees_all;
  return request;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

class Owners : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    reader_ = std::move(*EventReader::open(folder_->database()));
    hub_ = std::make_unique<EventHub>(*reader_, EventRules{std::chrono::milliseconds(5), 2});
    ASSERT_TRUE(hub_->start([](const JobEvent&) {}));
    views_ = std::make_unique<ViewService>(*jobs_, *folder_, ViewRules{});
    add_job_routes(router_, *jobs_);
    add_result_routes(router_, *jobs_);
    add_view_routes(router_, *jobs_, *views_);
    add_event_routes(router_, *jobs_, *hub_);
    add_upload_routes(router_, *jobs_, *folder_, {});
    add_service_routes(router_);
  }
  void TearDown() override { hub_->stop(); }

  Job submit_as(const std::string& owner) {
    Upload upload = make_upload();
    upload.owner = owner;
    auto job = jobs_->submit(upload);
    EXPECT_TRUE(job) << job.error().message;
    return job ? *job : Job{};
  }
  HttpAnswer ask(const std::string& method, const std::string& path, const Viewer& viewer,
                 const std::string& body = "") {
    HttpRequest request = request_to(method, path, viewer);
    request.body = body;
    return router_.answer(request);
  }
  api::ParsedJson json_of(const std::string& path, const Viewer& viewer) {
    const HttpAnswer answer = ask("GET", path, viewer);
    EXPECT_EQ(answer.status, 200) << answer.body;
    const auto json = api::parse_json(answer.body, "answer");
    return json ? *json : api::ParsedJson();
  }
  std::vector<std::string> listed(const Viewer& viewer) {
    std::vector<std::string> ids;
    const auto page = json_of("/v1/jobs", viewer);
    for (const auto& job : page.at("jobs")) ids.push_back(job.at("id"));
    return ids;
  }
  /// What a listener is sent until nothing comes any more.
  std::string heard(const Viewer& viewer, const std::string& last) {
    HttpRequest request = request_to("GET", "/v1/events", viewer);
    request.header = [last](std::string_view name) -> std::optional<std::string> {
      return name == "Last-Event-ID" ? std::optional(last) : std::nullopt;
    };
    const HttpAnswer answer = router_.answer(request);
    EXPECT_EQ(answer.status, 200) << answer.body;
    std::string text;
    for (std::string piece = "first"; !piece.empty();) {
      piece.clear();
      if (!answer.stream(piece)) break;
      text += piece;
    }
    return text;
  }

  Router router_;
  std::unique_ptr<EventReader> reader_;
  std::unique_ptr<EventHub> hub_;
  std::unique_ptr<ViewService> views_;
};

TEST_F(Owners, EveryRouteOfAJobIsNotFoundForOthersInTheWordsOfAnUnknownJob) {
  const Job annas = submit_as("anna");
  const auto document =
      api::parse_json(openapi_json(), "openapi.json", {.bytes = 4 << 20, .values = 200'000});
  ASSERT_TRUE(document) << document.error().message;
  std::ptrdiff_t asked = 0;
  for (const auto& [path, operations] : document->at("paths").items()) {
    if (path.find("{id}") == path.npos) continue;
    for (const auto& [name, operation] : operations.items()) {
      if (name == "parameters") continue;
      std::string method;
      for (const char c : name) method += static_cast<char>(std::toupper(c));
      const std::string theirs = replaced(path, "{id}", annas.id), unknown = replaced(path, "{id}", kUnknown);
      const HttpAnswer answer = ask(method, theirs, {"bert"});
      EXPECT_EQ(answer.status, 404) << method << " " << path << ": " << answer.body;
      const HttpAnswer of_unknown = ask(method, unknown, {"bert"});
      EXPECT_EQ(replaced(answer.body, annas.id, kUnknown), of_unknown.body) << method << " " << path;
      EXPECT_EQ(of_unknown.status, 404) << method << " " << path;
      EXPECT_EQ(ask(method, theirs, {""}).status, 404)
          << method << " " << path << ": nobody's name is no key";
      ++asked;
    }
  }
  const auto ours = std::count_if(router_.routes().begin(), router_.routes().end(), [](const Route& route) {
    return route.pattern.find("{id}") != std::string::npos;
  });
  EXPECT_EQ(asked, ours);
  EXPECT_EQ(job(annas.id).version, annas.version) << "nothing was done to it";
}

TEST_F(Owners, NoUploadGoesPastTheGuard) {
  for (const Route& route : router_.routes()) {
    if (route.upload) {
      EXPECT_EQ(route.pattern.find("{id}"), std::string::npos) << route.pattern;
    }
  }
}

TEST_F(Owners, TheirOwnJobsAreTheirsWholly) {
  const Job annas = submit_as("anna");
  const std::string path = "/v1/jobs/" + annas.id;
  EXPECT_EQ(json_of(path, {"anna"}).at("owner"), "anna");
  EXPECT_EQ(ask("PATCH", path, {"anna"}, R"({"priority": 60})").status, 200);
  EXPECT_EQ(ask("DELETE", path, {"anna"}).status, 409) << "it is queued";
  EXPECT_EQ(ask("POST", path + "/cancel", {"anna"}).status, 202);
  EXPECT_EQ(ask("DELETE", path, {"anna"}).status, 204);
}

TEST_F(Owners, AListHasTheirOwnJobsAndForAdminsAll) {
  const std::string anna = submit_as("anna").id, bert = submit_as("bert").id, nobody = submit_as("").id;
  EXPECT_EQ(listed({"anna"}), std::vector{anna});
  EXPECT_EQ(listed({"bert"}), std::vector{bert});
  EXPECT_EQ(listed({"carl"}), std::vector<std::string>{});
  EXPECT_EQ(listed({"carl", true}), (std::vector{nobody, bert, anna}));
  EXPECT_EQ(ask("GET", "/v1/jobs/" + nobody, {"anna"}).status, 404) << "of before there were tokens";
  EXPECT_EQ(json_of("/v1/jobs/" + nobody, {"root", true}).at("owner"), "");
  HttpRequest wants_annas = request_to("GET", "/v1/jobs", {"bert"});
  wants_annas.query = {{"owner", "anna"}};
  const auto page = api::parse_json(router_.answer(wants_annas).body, "answer");
  EXPECT_TRUE(page->at("jobs").empty());
}

TEST_F(Owners, PagesOfOwnJobsAreWholeAmongThoseOfOthers) {
  std::vector<std::string> annas;
  for (int i = 0; i < 7; ++i) {
    annas.insert(annas.begin(), submit_as("anna").id);
    for (int k = 0; k < 5; ++k) submit_as("bert");
  }
  std::vector<std::string> seen;
  for (std::string cursor; seen.size() < 20;) {
    HttpRequest request = request_to("GET", "/v1/jobs", {"anna"});
    request.query = {{"limit", "3"}, {"state", "queued"}};
    if (!cursor.empty()) request.query.emplace_back("cursor", cursor);
    const auto page = api::parse_json(router_.answer(request).body, "answer");
    ASSERT_TRUE(page);
    for (const auto& entry : page->at("jobs")) seen.push_back(entry.at("id"));
    if (page->at("next_cursor").is_null()) break;
    cursor = page->at("next_cursor");
  }
  EXPECT_EQ(seen, annas);
}

TEST_F(Owners, ABatchTouchesOnlyTheirOwn) {
  const Job annas = submit_as("anna"), berts = submit_as("bert");
  const std::string body =
      R"({"action": "cancel", "ids": [")" + annas.id + R"(", ")" + berts.id + R"(", ")" + kUnknown + R"("]})";
  const HttpAnswer answer = ask("POST", "/v1/jobs/batch", {"bert"}, body);
  ASSERT_EQ(answer.status, 200) << answer.body;
  const auto results = api::parse_json(answer.body, "answer")->at("results");
  EXPECT_EQ(results[0].at("status"), 404);
  EXPECT_EQ(replaced(results[0].at("detail"), annas.id, kUnknown),
            results[2].at("detail").get<std::string>());
  EXPECT_EQ(results[1].at("status"), 202);
  EXPECT_EQ(job(annas.id).state, api::JobState::queued);
}

TEST_F(Owners, TheQueueCountsTheirOwnAndAPlaceIsANumberAmongAll) {
  submit_as("anna");
  const Job berts = submit_as("bert");
  EXPECT_EQ(json_of("/v1/queue", {"bert"}).at("jobs").at("queued"), 1);
  EXPECT_EQ(json_of("/v1/queue", {"carl"}).at("jobs").at("queued"), 0);
  EXPECT_EQ(json_of("/v1/queue", {"root", true}).at("jobs").at("queued"), 2);
  EXPECT_EQ(json_of("/v1/jobs/" + berts.id, {"bert"}).at("queue_position"), 2);
}

TEST_F(Owners, ListenersHearOfTheirOwnJobsAlsoAfterABreak) {
  const Job annas = submit_as("anna");
  const Claim claimed = claim();
  std::vector<Job> berts;
  for (int i = 0; i < 130; ++i) berts.push_back(submit_as("bert"));
  const Job second = submit_as("anna");
  ASSERT_TRUE(store_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.25, "half", 3.0}));

  const std::string annas_news = heard({"anna"}, "0");
  EXPECT_NE(annas_news.find(annas.id), annas_news.npos);
  EXPECT_NE(annas_news.find("event: progress"), annas_news.npos);
  EXPECT_NE(annas_news.find(second.id), annas_news.npos) << "beyond a page of others' events";
  for (const Job& other : berts) ASSERT_EQ(annas_news.find(other.id), annas_news.npos);

  const std::string berts_news = heard({"bert"}, "0");
  for (const Job& own : berts) ASSERT_NE(berts_news.find(own.id), berts_news.npos) << "two pages of them";
  EXPECT_EQ(berts_news.find(annas.id), berts_news.npos) << "neither events nor progress";

  const std::size_t at = annas_news.find("id: "), end = annas_news.find('\n', at);
  const std::string after_first = heard({"anna"}, annas_news.substr(at + 4, end - at - 4));
  EXPECT_EQ(after_first.find(annas_news.substr(at, end - at + 1)), after_first.npos) << "it has had that one";
  EXPECT_NE(after_first.find(second.id), after_first.npos);

  const std::string all = heard({"root", true}, "0");
  EXPECT_NE(all.find(annas.id), all.npos);
  EXPECT_NE(all.find(berts.back().id), all.npos);
}

TEST_F(Owners, TheSameKeyOfTwoOwnersIsTwoKeys) {
  Upload first = make_upload(), second = make_upload();
  first.owner = "anna";
  second.owner = "bert";
  const auto annas = jobs_->submit(first, *jobs_->hold_key("anna", "k"));
  const auto berts = jobs_->submit(second, *jobs_->hold_key("bert", "k"));
  ASSERT_TRUE(annas && berts);
  EXPECT_NE(annas->job.id, berts->job.id);
  EXPECT_FALSE(berts->replayed);
}

}  // namespace
}  // namespace server
