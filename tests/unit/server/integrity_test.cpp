// Files that changed on the disk: found a share at a time, remembered, and forgotten when they are whole
// again.
#include "server/jobs/integrity_check.h"

#include <sys/resource.h>
#include <unistd.h>

#include <thread>

#include "server/artefacts/verify.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using namespace std::chrono_literals;

class IntegrityTest : public ServiceTest {
 protected:
  /// A job that has succeeded, with these files, one byte each.
  Job finished(const std::vector<std::string>& paths) {
    const Job submitted = submit();
    const Claim claimed = claim();
    Results results;
    for (const std::string& path : paths) {
      write_text(jobs_->folder_of(submitted) / "artefacts" / path, "x");
      results.artefacts.push_back({path, "image/png", 1, sha256_of("x")});
    }
    for (api::FrameIndex frame = 0; frame < 3; ++frame)
      results.key_frames.frames.push_back({frame, api::FrameKind::key, 0.0});
    EXPECT_TRUE(store_->succeed(claimed.lease, results, "{}"));
    return job(submitted.id);
  }

  void change(const Job& job, const std::string& path, std::string_view to) {
    write_text(jobs_->folder_of(job) / "artefacts" / path, to);
  }

  std::unique_ptr<IntegrityCheck> with(std::chrono::milliseconds time_max) {
    return std::make_unique<IntegrityCheck>(*store_, *folder_, IntegrityRules{24h, time_max},
                                            [this] { return now_ms_.load(); });
  }
};

TEST_F(IntegrityTest, WhatChangedIsRefusedUntilItIsWholeAgain) {
  const Job first = finished({"a.png", "b.png"}), second = finished({"a.png"});
  const auto check = with(1h);
  ASSERT_TRUE(check->check());
  EXPECT_EQ(check->report().damaged_files, 0);
  EXPECT_EQ(check->report().files, 3);
  EXPECT_EQ(check->report().round_ms, now_ms_);

  change(first, "b.png", "y");
  std::filesystem::remove(jobs_->folder_of(second) / "artefacts/a.png");
  ASSERT_TRUE(check->check());
  EXPECT_EQ(check->report().damaged_files, 2);
  EXPECT_TRUE(jobs_->artefact(first, "a.png"));
  const auto refused = jobs_->artefact(first, "b.png");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().violations.at(0).code, kDamagedFile);
  EXPECT_EQ(refused.error().violations.at(0).file, "b.png");
  EXPECT_FALSE(jobs_->artefact(second, "a.png"));
  EXPECT_TRUE(jobs_->must_be_whole(first, "a*"));
  EXPECT_FALSE(jobs_->must_be_whole(first));

  change(first, "b.png", "x");
  ASSERT_TRUE(jobs_->remove(second.id));
  ASSERT_TRUE(check->check());
  EXPECT_EQ(check->report().damaged_files, 0) << "one is whole again, the other gone with its job";
  EXPECT_TRUE(jobs_->artefact(first, "b.png"));
}

TEST_F(IntegrityTest, InputsAreLookedAtToo) {
  Upload upload = make_upload();
  const std::filesystem::path input = folder_->upload(upload.id) / "input";
  for (InputFile& file : upload.inputs) {
    const std::string bytes = read_text(input / file.name);
    file.bytes = static_cast<std::int64_t>(bytes.size());
    file.sha256 = sha256_of(bytes);
  }
  const auto job = jobs_->submit(upload);
  ASSERT_TRUE(job);
  EXPECT_EQ(store_->inputs(job->seq)->at(1).sha256, upload.inputs[0].sha256);
  EXPECT_TRUE(jobs_->must_have_whole_inputs(*job));
  auto check = with(1h);
  ASSERT_TRUE(check->check());
  EXPECT_EQ(check->report().files, 2);
  EXPECT_EQ(check->report().damaged_files, 0);

  write_text(jobs_->folder_of(*job) / "input/scene.obj", "v 0 0 1\n");
  const api::Status changed = jobs_->must_have_whole_inputs(*job);
  ASSERT_FALSE(changed);
  EXPECT_NE(changed.error().message.find("input 'scene.obj'"), std::string::npos) << changed.error().message;
  for (int share = 0; share < 3; ++share) ASSERT_TRUE(with(0ms)->check());
  EXPECT_EQ(*store_->count_damaged(), 1);
  const api::Status refused = jobs_->must_be_whole(*job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().violations.at(0).file, "input/scene.obj");
  EXPECT_TRUE(jobs_->must_be_whole(*job, "radiosity*"));

  auto database = Database::open_to_read(folder_->database());
  ASSERT_TRUE(database);
  EXPECT_EQ(kept_files(*database)->size(), 2u) << "what the check of the command line reads";
  write_text(jobs_->folder_of(*job) / "input/scene.obj", "v 0 0 0\n");
  ASSERT_TRUE(with(1h)->check());
  EXPECT_EQ(*store_->count_damaged(), 0);
}

// Without a descriptor a file cannot be opened: a whole one must not be refused for that.
TEST_F(IntegrityTest, WhatCannotBeLookedAtStaysAsItIsKnown) {
  const Job whole = finished({"a.png", "b.png"});
  change(whole, "b.png", "y");
  const auto check = with(1h);
  ASSERT_TRUE(check->check());
  ASSERT_EQ(check->report().damaged_files, 1);
  const std::filesystem::path folder = jobs_->folder_of(whole) / "artefacts";
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  // As many as the database takes that is opened for the check; one is too few to open a file in a folder.
  for (rlim_t more = 0; more < 12; ++more) {
    const int lowest_free = ::dup(0);
    ::close(lowest_free);
    const rlimit few{static_cast<rlim_t>(lowest_free) + more, before.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
    (void)check->check();
    ::setrlimit(RLIMIT_NOFILE, &before);
    EXPECT_EQ(check->report().damaged_files, 1) << "with " << more << " descriptors more";
    EXPECT_TRUE(jobs_->artefact(whole, "a.png"));
  }
}

TEST_F(IntegrityTest, AShareAtATimeComesRoundAlsoAcrossRestarts) {
  const Job whole = finished({"a.png", "b.png", "c.png"});
  change(whole, "c.png", "y");
  for (const int damaged : {0, 0, 1}) {
    const auto check = with(0ms);  // the time is over after one file
    ASSERT_TRUE(check->check());
    EXPECT_EQ(check->report().files, 1);
    EXPECT_EQ(check->report().damaged_files, damaged);
    EXPECT_EQ(check->report().round_ms, 0);
    restart();
  }
  const auto check = with(0ms);
  EXPECT_EQ(check->report().damaged_files, 1) << "known since before the restart";
  ASSERT_TRUE(check->check());
  EXPECT_EQ(check->report().round_ms, now_ms_) << "all have been looked at";
  change(whole, "a.png", "y");
  ASSERT_TRUE(check->check());
  EXPECT_EQ(check->report().damaged_files, 2) << "it begins with the first again";
}

TEST_F(IntegrityTest, ADatabaseThatRefersToNothingIsAFinding) {
  {
    auto database = Database::open(folder_->database());
    ASSERT_TRUE(database);
    ASSERT_TRUE(database->execute("PRAGMA foreign_keys=OFF; INSERT INTO job_label VALUES (4711, 'a', 'b')"));
  }
  const auto check = with(1h);
  ASSERT_TRUE(check->check());
  ASSERT_EQ(check->report().database.size(), 1u);
  EXPECT_NE(check->report().database.front().find("job_label"), std::string::npos);
}

TEST_F(IntegrityTest, StopsInTheMiddleAndRunsByItselfWhenItsTimeHasCome) {
  finished({"a.png"});
  IntegrityCheck check(*store_, *folder_, {20ms, 1h}, [this] { return now_ms_.load(); });
  check.start();
  for (int k = 0; k < 500 && check.report().files < 3; ++k) std::this_thread::sleep_for(10ms);
  EXPECT_GE(check.report().files, 3);
  check.stop();
  const api::Status stopped = check.check();
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().fault, api::Fault::stopped);
}

}  // namespace
}  // namespace server
