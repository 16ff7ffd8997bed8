// What we answer, without a socket.
#include "server/http/conditions.h"
#include "server/http/dashboard_routes.h"
#include "server/http/job_json.h"
#include "server/http/ops_routes.h"
#include "server/http/problem.h"
#include "server/http/router.h"
#include "server/http/routes.h"
#include "server/http/upload_receiver.h"

#include <map>
#include <set>

#include "api/json/json_text.h"
#include "server/text.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

HttpRequest get(std::string path, std::map<std::string, std::string> headers = {}) {
  HttpRequest request{"GET", std::move(path), {}, {}};
  request.header = [headers](std::string_view name) -> std::optional<std::string> {
    const auto found = headers.find(std::string(name));
    return found == headers.end() ? std::nullopt : std::optional(found->second);
  };
  return request;
}

HttpAnswer ten_bytes() {
  HttpAnswer answer;
  answer.content_type = "text/plain";
  answer.body = "0123456789";
  answer.etag = "tag";
  answer.ranges = true;
  return answer;
}

HttpAnswer ranged(const std::string& range, std::map<std::string, std::string> headers = {}) {
  headers["Range"] = range;
  HttpAnswer answer = ten_bytes();
  apply_conditions(get("/", headers), answer);
  return answer;
}

TEST(Conditions, ARangeIsCutAsTheRfcSays) {
  struct Case {
    const char* range;
    std::int64_t first;
    std::int64_t count;
  };
  for (const Case& expected : {Case{"bytes=0-0", 0, 1}, Case{"bytes=2-5", 2, 4}, Case{"bytes=5-", 5, 5},
                               Case{"bytes=-3", 7, 3}, Case{"bytes=-30", 0, 10}, Case{"bytes=8-100", 8, 2},
                               Case{"bytes=8-99999999999999999999", 8, 2}, Case{"BYTES=2-5", 2, 4}}) {
    const HttpAnswer answer = ranged(expected.range);
    EXPECT_EQ(answer.status, 206) << expected.range;
    ASSERT_TRUE(answer.part.has_value()) << expected.range;
    EXPECT_EQ(answer.part->first, expected.first) << expected.range;
    EXPECT_EQ(answer.part->count, expected.count) << expected.range;
  }
}

TEST(Conditions, ARangeOutsideTheFileIs416WithItsSize) {
  for (const char* range : {"bytes=10-", "bytes=10-20", "bytes=-0", "bytes=99999999999999999999-"}) {
    const HttpAnswer answer = ranged(range);
    EXPECT_EQ(answer.status, 416) << range;
    EXPECT_EQ(answer.headers.back(), (std::pair<std::string, std::string>("Content-Range", "bytes */10")))
        << range;
  }
}

TEST(Conditions, WhatIsNoSingleRangeGetsTheWhole) {
  for (const char* range : {"bytes=0-1,3-4", "lines=0-1", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-2",
                            "bytes=+1-2", "bytes=1-2x", "bytes=-5-2", "bytes", ""})
    EXPECT_EQ(ranged(range).status, 200) << range;
}

TEST(Conditions, IfRangeGuardsAgainstMixingTwoVersions) {
  EXPECT_EQ(ranged("bytes=0-1", {{"If-Range", "\"tag\""}}).status, 206);
  EXPECT_EQ(ranged("bytes=0-1", {{"If-Range", "\"other\""}}).status, 200);
  EXPECT_EQ(ranged("bytes=0-1", {{"If-Range", "W/\"tag\""}}).status, 200) << "weak tags do not do";
}

TEST(Conditions, NamesEtagReadsLists) {
  EXPECT_TRUE(names_etag("\"tag\"", "tag"));
  EXPECT_TRUE(names_etag("\"a\", W/\"tag\" , \"b\"", "tag"));
  EXPECT_TRUE(names_etag("*", "tag"));
  for (const char* list : {"", "tag", "\"tag", "\"tagx\"", "\"xtag\"", ",", "\"\""})
    EXPECT_FALSE(names_etag(list, "tag")) << list;
}

TEST(Router, TellsUnknownPathsFromUnknownMethods) {
  Router router;
  router.add("GET", "/a/{x}/b",
             [](const auto&, const PathValues& values) { return json_answer(values.at("x")); });
  router.add("DELETE", "/a/{x}/b", [](const auto&, const auto&) { return json_answer("gone"); });
  EXPECT_EQ(router.answer(get("/a/1/b")).body, "1");
  HttpRequest head = get("/a/1/b");
  head.method = "HEAD";
  EXPECT_EQ(router.answer(head).status, 200);
  HttpRequest post = get("/a/1/b");
  post.method = "POST";
  const HttpAnswer refused = router.answer(post);
  EXPECT_EQ(refused.status, 405);
  EXPECT_EQ(refused.headers.back().second, "DELETE, GET, HEAD");
  for (const char* path : {"/a/1", "/a//b", "/a/1/b/", "/a/1/b/c", "/", "", "a/1/b", "/a/1/c"})
    EXPECT_EQ(router.answer(get(path)).status, 404) << path;
}

TEST(Router, ANameMayHaveAnEnding) {
  Router router;
  router.add("GET", "/a/{x}.npy",
             [](const auto&, const PathValues& values) { return json_answer(values.at("x")); });
  EXPECT_EQ(router.answer(get("/a/b.npy")).body, "b");
  EXPECT_EQ(router.answer(get("/a/b.c.npy")).body, "b.c");
  for (const char* path : {"/a/.npy", "/a/b", "/a/b.npz", "/a/npy", "/a/b.npy/c", "/a/"})
    EXPECT_EQ(router.answer(get(path)).status, 404) << path;
}

TEST(Router, SaysWhereToLookWhenThereIsNothingAtAPath) {
  Router router;
  router.add("GET", "/a/{x}", [](const auto&, const auto&) { return json_answer("{}"); });
  for (const char* path : {"/", "/b", "/a/1//"})
    EXPECT_NE(router.answer(get(path)).body.find("/openapi.json"), std::string::npos) << path;
  EXPECT_NE(router.answer(get("/a/1/")).body.find("without the slash at its end"), std::string::npos);
}

TEST(Problem, TellsNothingOfWhatFailedInside) {
  const HttpAnswer answer = problem({api::Fault::internal, "/secret/path: SQL went wrong"}, "/v1/jobs");
  EXPECT_EQ(answer.status, 500);
  EXPECT_EQ(answer.body.find("secret"), std::string::npos) << answer.body;
}

TEST(Problem, EveryFaultHasAStatus) {
  const std::pair<api::Fault, int> expected[]{
      {api::Fault::invalid_request, 422},  {api::Fault::not_found, 404}, {api::Fault::wrong_state, 409},
      {api::Fault::out_of_resources, 503}, {api::Fault::stopped, 503},   {api::Fault::internal, 500},
      {api::Fault::disk_full, 507}};
  for (const auto& [fault, status] : expected) EXPECT_EQ(problem({fault, "x"}, "/").status, status);
}

TEST(UtcText, IsRfc3339) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(utc_text(1'700'000'000'042), "2023-11-14T22:13:20.042Z");
}

TEST(ImagesByFrame, SortsPathsIntoFramesAndCameras) {
  const auto file = [](std::string path) {
    return ArtefactFile{std::move(path), "image/png", 1, std::string(64, '0')};
  };
  const auto frames =
      images_by_frame({file("images/a/0000.png"), file("images/a/0000.exr"), file("images/b.c/0001.exr"),
                       file("images/a/0007.png"), file("images/a/x.png"), file("radiosity.npy")},
                      2);
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_EQ(frames[0].cameras.size(), 1u);
  EXPECT_TRUE(frames[0].cameras[0].png && frames[0].cameras[0].exr);
  ASSERT_EQ(frames[1].cameras.size(), 1u);
  EXPECT_EQ(frames[1].cameras[0].name, "b.c");
  EXPECT_EQ(image_path("a", 7, "png"), "images/a/0007.png");
  EXPECT_EQ(image_path("a", 12345, "png"), "images/a/12345.png");
}

TEST(SafeBaseName, KeepsNamesAndRefusesWhatIsNone) {
  EXPECT_EQ(safe_base_name("room.mtl"), "room.mtl");
  EXPECT_EQ(safe_base_name("../../etc/passwd"), "passwd");
  EXPECT_EQ(safe_base_name("C:\\rooms\\room.mtl"), "room.mtl");
  EXPECT_EQ(safe_base_name("h\xC3\xA4user 2.mtl"), "h\xC3\xA4user 2.mtl");
  for (const char* not_utf8 : {"h\xE4user.mtl", "\xC0\xAE.mtl", "a\xED\xA0\x80.mtl", "cut\xC3"})
    EXPECT_EQ(safe_base_name(not_utf8), std::nullopt) << "as archives have it";
  for (const std::string& name :
       {std::string(""), std::string("a/"), std::string(".."), std::string(".hidden"), std::string("a\nb"),
        std::string("a\0b", 3), std::string(201, 'a')})
    EXPECT_EQ(safe_base_name(name), std::nullopt) << name;
}

class UploadTest : public ServiceTest {
 protected:
  UploadLimits limits_;

  /// The refusal's status and code after these parts, or "" when all is well.
  std::string outcome(const std::vector<std::array<std::string, 3>>& parts) {
    UploadReceiver receiver(*folder_, new_job_id(now_ms_), limits_);
    for (const auto& [field, name, content] : parts)
      if (!receiver.begin_part(field, name) || !receiver.take(content)) break;
    const auto upload = receiver.finish();
    if (upload) {
      jobs_->discard(*upload);
      return "";
    }
    const auto& refusal = *receiver.refusal();
    return std::to_string(refusal.status) +
           (refusal.error.violations.empty()
                ? ""
                : " " + refusal.error.violations[0].code + " " + refusal.error.violations[0].file);
  }
};

const std::array<std::string, 3> kScene{"scene", "my room.obj", "v 0 0 0\n"};
const std::array<std::string, 3> kAnimation{"animation", "a.json", "{}"};

TEST_F(UploadTest, TakesTheFourKindsOfPartsUnderTheirNames) {
  UploadReceiver receiver(*folder_, "job_x", limits_);
  ASSERT_TRUE(receiver.begin_part("scene", "my room.obj") && receiver.take("v 0 ") && receiver.take("0 0\n"));
  ASSERT_TRUE(receiver.begin_part("materials", "some/where/room.mtl") && receiver.take("newmtl a\n"));
  ASSERT_TRUE(receiver.begin_part("textures", "wood.png") && receiver.take("png"));
  ASSERT_TRUE(receiver.begin_part("animation", "") && receiver.take("{}"));
  const auto upload = receiver.finish();
  ASSERT_TRUE(upload);
  const auto input = folder_->upload("job_x") / "input";
  EXPECT_EQ(read_text(input / "scene.obj"), "v 0 0 0\n");
  EXPECT_EQ(read_text(input / "room.mtl"), "newmtl a\n");
  EXPECT_EQ(read_text(input / "animation.json"), "{}");
  ASSERT_EQ(upload->inputs.size(), 4u);
  EXPECT_EQ(upload->inputs[0].bytes, 8);
  for (const InputFile& file : upload->inputs)
    EXPECT_EQ(file.sha256, sha256_of(read_text(input / file.name))) << file.name;
}

TEST_F(UploadTest, RefusesWrongPartsAndLeavesNothing) {
  EXPECT_EQ(outcome({kScene, kAnimation}), "");
  EXPECT_EQ(outcome({kAnimation}), "422 missing scene.obj");
  EXPECT_EQ(outcome({kScene}), "422 missing animation.json");
  EXPECT_EQ(outcome({}), "422 missing scene.obj");
  EXPECT_EQ(outcome({kScene, kScene, kAnimation}), "422 duplicate_part scene.obj");
  EXPECT_EQ(outcome({{"scenery", "a", "b"}}), "422 unknown_part scenery");
  EXPECT_EQ(outcome({kScene, kAnimation, {"materials", "a.mtl", ""}, {"materials", "b/A.MTL", ""}}),
            "422 duplicate_part A.MTL");
  for (const char* name : {"", "..", "scene.obj", "Animation.JSON", "a\x01.mtl"})
    EXPECT_EQ(outcome({kScene, kAnimation, {"materials", name, ""}}), "422 bad_name materials") << name;
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(UploadTest, HintsAtTheFileWhereOnlyAValueCame) {
  const auto hint_of = [&](const char* scene_name, const char* animation_name) {
    UploadReceiver receiver(*folder_, new_job_id(now_ms_), limits_);
    EXPECT_TRUE(receiver.begin_part("scene", scene_name) && receiver.begin_part("animation", animation_name));
    return receiver.hint();
  };
  EXPECT_EQ(hint_of("room.obj", "a.json"), "");
  EXPECT_NE(hint_of("", "a.json").find("-F scene=@FILE"), std::string::npos);
  EXPECT_NE(hint_of("room.obj", "").find("-F animation=@FILE"), std::string::npos);
}

TEST_F(UploadTest, RefusesWhatIsTooLargeOrTooMany) {
  limits_.total_bytes = 100;
  limits_.animation_bytes = 10;
  limits_.textures = 2;
  EXPECT_EQ(outcome({{"scene", "", std::string(101, 'v')}}), "413 too_large scene.obj");
  EXPECT_EQ(outcome({{"scene", "", std::string(98, 'v')}, kAnimation}), "") << "exactly at the limit";
  EXPECT_EQ(outcome({{"scene", "", std::string(98, 'v')}, {"animation", "", "{ }"}}),
            "413 too_large animation.json");
  EXPECT_EQ(outcome({kScene, {"animation", "", std::string(11, ' ')}}), "413 too_large animation.json");
  EXPECT_EQ(outcome({{"textures", "1", ""}, {"textures", "2", ""}, {"textures", "3", ""}}), "413 too_many 3");
  EXPECT_TRUE(std::filesystem::is_empty(folder_->uploads()));
}

TEST_F(ServiceTest, EveryRouteIsInTheContractAndTheReverse) {
  Router router;
  add_job_routes(router, *jobs_);
  add_result_routes(router, *jobs_);
  ViewService views(*jobs_, *folder_, {});
  add_view_routes(router, *jobs_, views);
  const auto events = EventReader::open(folder_->database());
  ASSERT_TRUE(events);
  EventHub hub(**events);
  add_event_routes(router, *jobs_, hub);
  TokenFolder tokens(temporary_.path());
  add_login_routes(router, tokens, system_clock_ms);
  HttpMetrics http_metrics;
  JobMetrics job_metrics;
  add_ops_routes(router, {*jobs_, *store_, *folder_, hub, http_metrics, job_metrics});
  add_limits_route(router, {});
  add_upload_routes(router, *jobs_, *folder_, {});
  add_service_routes(router);
  add_dashboard_routes(router, {});
  std::set<std::string> ours;
  for (const Route& route : router.routes()) ours.insert(route.method + " " + route.pattern);

  const auto document = api::parse_json(openapi_json(), "openapi.json");
  ASSERT_TRUE(document) << document.error().message;
  std::set<std::string> theirs;
  for (const auto& [path, operations] : document->at("paths").items())
    for (const auto& [method, operation] : operations.items()) {
      if (method == "parameters") continue;
      std::string upper;
      for (const char c : method) upper += static_cast<char>(std::toupper(c));
      theirs.insert(upper + " " + path);
    }
  EXPECT_EQ(ours, theirs);
}

TEST_F(ServiceTest, ABadParameterIsNamed) {
  Router router;
  add_job_routes(router, *jobs_);
  for (const auto& [name, value] : {std::pair{"limit", "0"}, {"cursor", "x"}, {"state", "asleep"}}) {
    HttpRequest request = get("/v1/jobs");
    request.query = {{name, value}};
    const HttpAnswer answer = router.answer(request);
    EXPECT_EQ(answer.status, 400);
    const auto document = api::parse_json(answer.body, "answer");
    ASSERT_TRUE(document && document->at("errors").size() == 1) << answer.body;
    EXPECT_EQ(document->at("errors")[0].at("file"), name);
  }
}

TEST_F(ServiceTest, AnUnknownStateIsAnsweredWithTheStates) {
  Router router;
  add_job_routes(router, *jobs_);
  HttpRequest request = get("/v1/jobs");
  request.query = {{"state", "done"}};
  const std::string body = router.answer(request).body;
  for (const api::JobState state : api::kJobStates)
    EXPECT_NE(body.find(api::name_of(state)), std::string::npos) << api::name_of(state);
}

TEST_F(ServiceTest, AListTellsOfReportsWithoutReadingThem) {
  const Job submitted = submit();
  ASSERT_TRUE(store_->fail(claim().lease, {"invalid_input", "no"}, {}, "{\"outcome\":\"failed\"}"));
  const auto page = jobs_->list({}, 10);
  ASSERT_TRUE(page);
  EXPECT_EQ(page->jobs.at(0).report, "");
  EXPECT_NE(job_page_json(*page).find("/v1/jobs/" + submitted.id + "/report.json"), std::string::npos);
  EXPECT_NE(job(submitted.id).report, "");
}

TEST_F(ServiceTest, APictureIsFoundWithoutReadingAllFilesOfAJob) {
  const Job submitted = submit();
  Results results;
  for (const char* path : {"images/a/0001.exr", "images/a/0001.png", "images/a/0002.png", "radiosity.npy"})
    results.artefacts.push_back({path, "image/png", 1, std::string(64, 'a')});
  for (api::FrameIndex frame = 0; frame < 3; ++frame)
    results.key_frames.frames.push_back({frame, api::FrameKind::key, 0.0});
  ASSERT_TRUE(store_->succeed(claim().lease, results, ""));
  EXPECT_EQ(jobs_->artefacts(job(submitted.id), image_path("*", 1, "*"))->size(), 2u);
  write_text(jobs_->folder_of(submitted) / "artefacts/images/a/0001.png", "x");
  Router router;
  add_result_routes(router, *jobs_);
  EXPECT_EQ(router.answer(get("/v1/jobs/" + submitted.id + "/frames/1/image.png")).status, 200);
  EXPECT_EQ(router.answer(get("/v1/jobs/" + submitted.id + "/frames/0/image.png")).status, 404);
}

/// Every $ref of the document, resolved in the document itself.
void expect_references_resolve(const api::ParsedJson& document, const api::ParsedJson& value, int& count) {
  if (value.is_object() && value.contains("$ref") && value["$ref"].is_string()) {
    const std::string reference = value["$ref"];
    ASSERT_TRUE(reference.starts_with("#/")) << reference;
    EXPECT_TRUE(document.contains(api::ParsedJson::json_pointer(reference.substr(1)))) << reference;
    ++count;
  }
  for (const auto& item : value)
    if (item.is_structured()) expect_references_resolve(document, item, count);
}

TEST(OpenApi, HasNoReferenceThatLeadsNowhere) {
  const auto document = api::parse_json(openapi_json(), "openapi.json");
  ASSERT_TRUE(document);
  int count = 0;
  expect_references_resolve(*document, *document, count);
  EXPECT_GT(count, 50);
}

TEST_F(ServiceTest, AJobOnItsWayShowsNoLinksToWhatIsNotThere) {
  const Job submitted = submit();
  const auto json = api::parse_json(job_json(submitted), "job");
  ASSERT_TRUE(json);
  EXPECT_EQ(json->at("state"), "queued");
  EXPECT_TRUE(json->at("reason").is_null());
  EXPECT_TRUE(json->at("started_at").is_null());
  EXPECT_TRUE(json->at("key_frame_count").is_null());
  EXPECT_TRUE(json->at("solved_frame_count").is_null());
  EXPECT_EQ(json->at("links").size(), 3u) << json->at("links");
  EXPECT_EQ(json->at("links").at("cancel"), "/v1/jobs/" + submitted.id + "/cancel");
}

}  // namespace
}  // namespace server
