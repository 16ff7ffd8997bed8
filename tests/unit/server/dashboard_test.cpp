// What browsers get, from a folder as the build makes it.
#include "server/http/dashboard_routes.h"

#include <fstream>
#include <map>

#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

class DashboardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    put("index.html", "<!doctype html>page");
    put("index.html.br", "brotli page");
    put("assets/keylume.4F2A.js", "script script script");
    put("assets/keylume.4F2A.js.gz", "gzip script");
    put("assets/keylume.4F2A.js.br", "brotli script");
    put("assets/keylume.77.css", "style");
    put("examples/index.json", R"({"examples":[]})");
    put("examples/garage/scene.obj", "v 0 0 0");
  }

  void put(const std::string& name, const std::string& bytes) {
    const auto path = temporary_.path() / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
  }

  HttpAnswer ask(const std::string& path, std::map<std::string, std::string> headers = {}) {
    auto files = read_dashboard(temporary_.path());
    EXPECT_TRUE(files) << files.error().message;
    return ask_of(std::move(*files), path, std::move(headers));
  }

  static HttpAnswer ask_of(DashboardFiles files, const std::string& path,
                           std::map<std::string, std::string> headers = {}) {
    Router router;
    add_dashboard_routes(router, std::move(files));
    HttpRequest request{"GET", path, {}, {}};
    request.header = [headers](std::string_view name) -> std::optional<std::string> {
      const auto found = headers.find(std::string(name));
      return found == headers.end() ? std::nullopt : std::optional(found->second);
    };
    return router.answer(request);
  }

  std::string refusal() {
    const auto files = read_dashboard(temporary_.path());
    return files ? "" : files.error().message;
  }

  TemporaryFolder temporary_;
};

std::string header_of(const HttpAnswer& answer, std::string_view name) {
  for (const auto& [key, value] : answer.headers)
    if (key == name) return value;
  return "";
}

TEST_F(DashboardTest, EveryPageIsTheSameDocumentAndAskedForEveryTime) {
  for (const char* path :
       {"/", "/new", "/jobs/job_01JDA2V7Y0K3V9X0Q2M7RA4N5P", "/compare", "/system", "/login"}) {
    const HttpAnswer answer = ask(path);
    EXPECT_EQ(answer.status, 200) << path;
    EXPECT_EQ(answer.body, "<!doctype html>page") << path;
    EXPECT_EQ(answer.content_type, "text/html; charset=utf-8");
    EXPECT_EQ(header_of(answer, "Cache-Control"), "no-cache");
    EXPECT_EQ(ask(path, {{"If-None-Match", "\"" + answer.etag + "\""}}).status, 304);
  }
  for (const char* path : {"/jobs", "/jobs/", "/jobs/a/b", "/index.html", "/other", "/new/"})
    EXPECT_EQ(ask(path).status, 404) << path;
}

TEST_F(DashboardTest, AssetsNeverChangeAndExamplesMay) {
  const HttpAnswer script = ask("/assets/keylume.4F2A.js");
  EXPECT_EQ(script.content_type, "text/javascript; charset=utf-8");
  EXPECT_EQ(header_of(script, "Cache-Control"), "public, max-age=31536000, immutable");
  EXPECT_EQ(ask("/assets/keylume.77.css").content_type, "text/css; charset=utf-8");
  const HttpAnswer example = ask("/examples/garage/scene.obj");
  EXPECT_EQ(example.body, "v 0 0 0");
  EXPECT_EQ(header_of(example, "Cache-Control"), "no-cache");
  EXPECT_EQ(ask("/examples/index.json").content_type, "application/json");
}

TEST_F(DashboardTest, TheSmallestCodingThatTheClientReadsIsSent) {
  struct Case {
    const char* accepted;
    const char* body;
    const char* coding;
  };
  for (const Case& expected :
       {Case{"gzip, deflate, br", "brotli script", "br"}, Case{"gzip", "gzip script", "gzip"},
        Case{"br;q=0, gzip;q=0.5", "gzip script", "gzip"}, Case{"gzip;q=0.0", "script script script", ""},
        Case{"*", "script script script", ""}, Case{"brx, xgzip", "script script script", ""},
        Case{"", "script script script", ""}}) {
    const HttpAnswer answer = ask("/assets/keylume.4F2A.js", {{"Accept-Encoding", expected.accepted}});
    EXPECT_EQ(answer.body, expected.body) << expected.accepted;
    EXPECT_EQ(header_of(answer, "Content-Encoding"), expected.coding) << expected.accepted;
    EXPECT_EQ(header_of(answer, "Vary"), "Accept-Encoding");
  }
  // Two codings of a file are two representations: one's tag must not stand for the other's bytes.
  EXPECT_NE(ask("/assets/keylume.4F2A.js", {{"Accept-Encoding", "br"}}).etag,
            ask("/assets/keylume.4F2A.js").etag);
}

TEST_F(DashboardTest, NothingFromElsewhereAndNothingInlineRuns) {
  for (const char* path : {"/", "/assets/keylume.4F2A.js", "/examples/garage/scene.obj"}) {
    const std::string policy = header_of(ask(path), "Content-Security-Policy");
    EXPECT_TRUE(policy.starts_with("default-src 'none'; script-src 'self'; style-src 'self';")) << path;
    EXPECT_NE(policy.find("frame-ancestors 'none'"), policy.npos);
    EXPECT_EQ(policy.find("unsafe"), policy.npos);
    EXPECT_EQ(policy.find("http"), policy.npos);
  }
}

TEST_F(DashboardTest, OnlyWhatWasReadAtTheStartIsServed) {
  auto files = read_dashboard(temporary_.path());
  ASSERT_TRUE(files);
  put("assets/later.00.js", "later");
  EXPECT_EQ(ask_of(std::move(*files), "/assets/later.00.js").status, 404);
  for (const char* path :
       {"/assets/..", "/assets/.", "/examples/../index.html", "/examples/garage/../index.json"})
    EXPECT_EQ(ask(path).status, 404) << path;
  EXPECT_EQ(ask("/assets/keylume.4F2A.js.br").status, 404) << "compressed ones go by the name of the whole";
}

TEST_F(DashboardTest, WhatADashboardDoesNotHoldIsRefused) {
  put("notes.txt", "x");
  EXPECT_NE(refusal().find("notes.txt"), std::string::npos);
  std::filesystem::remove(temporary_.path() / "notes.txt");
  put("assets/.hidden.js", "x");
  EXPECT_NE(refusal().find(".hidden.js"), std::string::npos);
  std::filesystem::remove(temporary_.path() / "assets/.hidden.js");
  put("assets/alone.js.gz", "x");
  EXPECT_NE(refusal().find("alone.js"), std::string::npos);
  std::filesystem::remove(temporary_.path() / "assets/alone.js.gz");
  std::filesystem::create_symlink("/etc/hostname", temporary_.path() / "assets/link.js");
  EXPECT_NE(refusal().find("link.js"), std::string::npos);
  std::filesystem::remove(temporary_.path() / "assets/link.js");
  EXPECT_EQ(refusal(), "");
  std::filesystem::remove(temporary_.path() / "index.html");
  EXPECT_NE(refusal().find("index.html"), std::string::npos);
}

TEST_F(DashboardTest, ItsSizeIsLimited) {
  const auto read = [&](const DashboardLimits& limits) {
    return bool(read_dashboard(temporary_.path(), limits));
  };
  EXPECT_TRUE(read({.files = 8}));
  EXPECT_FALSE(read({.files = 7}));
  std::int64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(temporary_.path()))
    if (entry.is_regular_file()) bytes += static_cast<std::int64_t>(entry.file_size());
  EXPECT_TRUE(read({.bytes = bytes}));
  EXPECT_FALSE(read({.bytes = bytes - 1}));
  EXPECT_FALSE(read({.folders_within_max = 1}));
}

TEST_F(DashboardTest, WithoutItAPageSaysHowToGetIt) {
  const HttpAnswer answer = ask_of({}, "/");
  EXPECT_EQ(answer.status, 200);
  EXPECT_NE(answer.body.find("npm"), std::string::npos);
  EXPECT_NE(answer.body.find("/docs"), std::string::npos);
  EXPECT_EQ(answer.body.find("<script"), std::string::npos);
  EXPECT_EQ(ask_of({}, "/jobs/x").body, answer.body);
  EXPECT_EQ(ask_of({}, "/assets/keylume.4F2A.js").status, 404);
  EXPECT_EQ(ask_of({}, "/examples/index.json").status, 404);
}

}  // namespace
}  // namespace server
