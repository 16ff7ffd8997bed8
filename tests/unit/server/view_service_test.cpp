// Views that are promised, without anybody who makes them; and the hashes of those that are made.
#include "server/workers/view_service.h"

#include <sys/resource.h>
#include <unistd.h>

#include <set>

#include "server/artefacts/verify.h"
#include "server/workers/view_hashes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using namespace std::chrono_literals;

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

class MadeFilesTest : public ViewServiceTest {
 protected:
  /// A view, as if it had been made; nobody makes it again.
  std::filesystem::path with_view(const Job& job) {
    const std::filesystem::path views = jobs_->folder_of(job) / "views";
    write_text(views / (name_ + ".json"), "{}");
    write_text(views / name_ / "0.png", "bytes");
    write_text(views / name_ / "manifest.json",
               R"({"artefacts":[{"path":"0.png","media_type":"image/png","bytes":5,"sha256":")" +
                   sha256_of("bytes") + "\"}]}");
    return views / name_;
  }
  ViewRules nobody_makes() {
    ViewRules rules;
    rules.at_once = 0;
    return rules;
  }
  const std::string name_ = std::string(32, 'a');
};

TEST_F(MadeFilesTest, ADamagedViewIsRemovedAndPromisedAgain) {
  const Job job = submit();
  const std::filesystem::path view = with_view(job);
  ViewService views(*jobs_, *folder_, nobody_makes());
  ASSERT_TRUE(views.view(job, name_));
  ASSERT_TRUE(views.check_made(1h, kNeverStops));
  EXPECT_EQ(views.view(job, name_)->state, MadeState::ready);
  write_text(view / "0.png", "other");
  ASSERT_TRUE(views.check_made(1h, kNeverStops));
  EXPECT_EQ(views.view(job, name_)->state, MadeState::waiting);
  EXPECT_FALSE(std::filesystem::exists(view));
  EXPECT_FALSE(std::filesystem::exists(view.string() + ".hashes"));
}

TEST_F(MadeFilesTest, EachCheckGoesOnFromWhereTheLastHadNoTimeLeft) {
  const Job first = submit(), second = submit();
  const std::filesystem::path views_of[] = {with_view(first), with_view(second)};
  ViewService views(*jobs_, *folder_, nobody_makes());
  for (const auto& view : views_of) write_text(view / "0.png", "other");
  const auto left = [&] {
    return std::filesystem::exists(views_of[0]) + std::filesystem::exists(views_of[1]);
  };
  ASSERT_TRUE(views.check_made(0ms, kNeverStops));
  EXPECT_EQ(left(), 1);
  ASSERT_TRUE(views.check_made(0ms, kNeverStops));
  EXPECT_EQ(left(), 0);
}

TEST_F(MadeFilesTest, ACheckGoesOnAfterARestartToo) {
  const Job first = submit(), second = submit();
  const std::filesystem::path views_of[] = {with_view(first), with_view(second)};
  for (const auto& view : views_of) write_text(view / "0.png", "other");
  ASSERT_TRUE(ViewService(*jobs_, *folder_, nobody_makes()).check_made(0ms, kNeverStops));
  with_view(first.id < second.id ? first : second);  // the one that was looked at
  restart();
  ASSERT_TRUE(ViewService(*jobs_, *folder_, nobody_makes()).check_made(0ms, kNeverStops));
  EXPECT_TRUE(std::filesystem::exists(views_of[first.id < second.id ? 0 : 1]));
  EXPECT_FALSE(std::filesystem::exists(views_of[first.id < second.id ? 1 : 0]));
}

/// As long as this lives, only so many more files can be open.
class FewDescriptors {
 public:
  explicit FewDescriptors(rlim_t more) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const int lowest_free = ::dup(0);
    ::close(lowest_free);
    const rlimit few{static_cast<rlim_t>(lowest_free) + more, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  rlimit before_{};
};

TEST_F(MadeFilesTest, WhatCannotBeOpenedNowIsNotTakenForDamaged) {
  const Job job = submit();
  const std::filesystem::path view = with_view(job);
  const ClaimedFile file{"0.png", 5, sha256_of("bytes")};
  ViewService views(*jobs_, *folder_, nobody_makes());
  {
    const FewDescriptors few(1);  // a folder can be listed, a file within it not opened
    const api::Status looked = verify_file(view, file);
    ASSERT_FALSE(looked);
    EXPECT_EQ(looked.error().fault, api::Fault::internal) << looked.error().message;
    EXPECT_TRUE(views.check_made(1h, kNeverStops));
    EXPECT_TRUE(std::filesystem::exists(view));
  }
  {
    const FewDescriptors none(0);
    EXPECT_FALSE(views.check_made(1h, kNeverStops)) << "it did not look";
  }
  EXPECT_TRUE(verify_file(view, file));
  std::filesystem::remove(view / "0.png");
  EXPECT_EQ(verify_file(view, file).error().fault, api::Fault::invalid_request);
  ASSERT_TRUE(views.check_made(1h, kNeverStops));
  EXPECT_FALSE(std::filesystem::exists(view));
}

TEST_F(MadeFilesTest, WhatWasNeverFinishedGoesAtTheNextStart) {
  const Job job = submit();
  const std::filesystem::path view = with_view(job), videos = jobs_->folder_of(job) / "videos";
  write_text(view.parent_path() / (".tmp." + name_) / "0.png", "half");
  write_text(view.parent_path() / (name_ + ".report.json"), "{}");
  write_text(view.parent_path() / (std::string(32, 'b') + ".hashes"), "");
  for (const char* name :
       {".tmp.7.a.mp4", "unsummed.mp4", "gone.mp4.sha256", "whole.mp4", "whole.mp4.sha256"})
    write_text(videos / name, "x");
  ViewService(*jobs_, *folder_, nobody_makes()).take_up_again();
  const auto names_in = [](const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      names.insert(entry.path().filename().string());
    return names;
  };
  EXPECT_EQ(names_in(view.parent_path()), (std::set<std::string>{name_, name_ + ".json"}));
  EXPECT_EQ(names_in(videos), (std::set<std::string>{"whole.mp4", "whole.mp4.sha256"}));
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
