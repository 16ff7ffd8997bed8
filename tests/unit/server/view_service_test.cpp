// Views that are promised, without anybody who makes them; and the hashes of those that are made.
#include "server/workers/view_service.h"

#include "server/artefacts/verify.h"
#include "server/workers/view_hashes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using ViewServiceTest = ServiceTest;

api::ViewRequest request_of(const char* canonical) {
  api::ViewRequest request;
  request.canonical_json = canonical;
  return request;
}

TEST_F(ViewServiceTest, WhatIsPromisedAlreadyMayBeAskedForAgainAtTheCap) {
  const Job job = submit();
  ViewRules rules;
  rules.at_once = 0;
  rules.views_per_job_max = 1;
  ViewService views(*jobs_, *folder_, rules);
  const auto first = views.ask(job, request_of("{\"a\":1}"));
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(views.ask(job, request_of("{\"b\":1}")).error().fault, api::Fault::out_of_resources);
  const auto again = views.ask(job, request_of("{\"a\":1}"));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->state, MadeState::waiting);
}

TEST_F(ViewServiceTest, HashesAreThoseOfWhenTheViewWasFirstRead) {
  const Job job = submit();
  ViewRules rules;
  rules.at_once = 0;
  const std::string name(32, 'a');
  const std::filesystem::path folder = jobs_->folder_of(job) / "views";
  write_text(folder / (name + ".json"), "{}");
  write_text(folder / name / "front/0.png", "bytes");
  write_text(folder / name / "manifest.json",
             R"({"artefacts":[{"path":"front/0.png","media_type":"image/png","bytes":5,"sha256":")" +
                 sha256_of("bytes") + "\"}]}");
  {
    ViewService views(*jobs_, *folder_, rules);
    EXPECT_TRUE(views.view(job, name));
  }
  write_text(folder / name / "front/0.png", "other");
  ViewService views(*jobs_, *folder_, rules);
  const auto view = views.view(job, name);
  ASSERT_TRUE(view);
  ASSERT_EQ(view->files.size(), 1u);
  EXPECT_EQ(view->files[0].sha256, sha256_of("bytes"));
  ASSERT_TRUE(views.remove(job, name));
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(ViewServiceTest, AFileThatIsNotOursTellsNoHashes) {
  const std::filesystem::path file = temporary_.path() / "x.hashes";
  const std::vector<ArtefactFile> files{{"front/a b.png", "image/png", 5, std::string(64, '0')}};
  ASSERT_TRUE(write_view_hashes(file, files));
  const auto same = read_view_hashes(file);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->at(0).path, "front/a b.png");
  EXPECT_EQ(same->at(0).bytes, 5);
  const std::string whole = read_text(file);
  for (const std::string& text : {std::string(), std::string("x"), whole.substr(0, whole.size() - 1),
                                  "keylume view 1\n" + std::string(64, '0') + "\t5\timage/png\t../a\n",
                                  "keylume view 1\n" + std::string(64, '0') + "\tx\timage/png\ta\n"}) {
    write_text(file, text);
    EXPECT_FALSE(read_view_hashes(file)) << text;
  }
}

}  // namespace
}  // namespace server
