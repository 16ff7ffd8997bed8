// What is kept, for whom, and what goes when there is no more room.
#include "server/artefacts/verify.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::Fault;

constexpr std::int64_t kHourMs = 3'600'000;

class Retention : public ServiceTest {
 protected:
  Upload upload_of(const std::string& owner, const std::string& options = "") {
    Upload upload = make_upload();
    upload.owner = owner;
    upload.options = options;
    return upload;
  }
  /// A job that has ended and takes so many bytes.
  std::string ended(std::int64_t bytes, const std::string& owner = "", const std::string& options = "") {
    const auto made = jobs_->submit(upload_of(owner, options));
    EXPECT_TRUE(made) << made.error().message;
    const Claim claimed = claim();
    EXPECT_TRUE(store_->fail(claimed.lease, {"invalid_input", "no"}, {}, ""));
    EXPECT_TRUE(store_->record_bytes(made->seq, bytes));
    now_ms_ += 1000;
    return made->id;
  }
  bool is_there(const std::string& id) { return jobs_->job(id) && std::filesystem::exists(folder_->job(id)); }
  api::Status send(const std::string& owner, const std::string& bytes, std::string sha256 = "") {
    if (sha256.empty()) sha256 = sha256_of(bytes);
    const auto from = folder_->upload("blob");
    write_text(from, bytes);
    api::Status kept = jobs_->keep_blob(owner, from, sha256);
    std::filesystem::remove(from);
    return kept;
  }
  bool has(const std::string& owner, const std::string& bytes) {
    return static_cast<bool>(jobs_->open_blob(owner, sha256_of(bytes)));
  }
  std::filesystem::path file_of(const std::string& bytes) {
    const std::string hash = sha256_of(bytes);
    return folder_->blobs() / hash.substr(0, 2) / hash;
  }
};

TEST_F(Retention, AJobThatIsPinnedOrKeptForLongerWhileItIsBeingCollectedStays) {
  const std::string pinned = ended(1, "", R"({"ttl_seconds": 3600})");
  const std::string longer = ended(1, "", R"({"ttl_seconds": 3600})");
  now_ms_ += 2 * kHourMs;
  const auto expired = store_->expired(10);
  ASSERT_TRUE(expired && expired->size() == 2);
  api::JobOptions pin, more;
  pin.pinned = true;
  more.ttl_seconds = {true, 24 * 3600};
  ASSERT_TRUE(jobs_->change(pinned, pin, std::nullopt) && jobs_->change(longer, more, std::nullopt));
  for (const std::string& id : *expired)
    EXPECT_EQ(store_->begin_removal(id, JobStore::RemovalOf::expired).error().fault, Fault::wrong_state);
  EXPECT_EQ(store_->begin_removal(pinned, JobStore::RemovalOf::unpinned).error().fault, Fault::wrong_state);
  EXPECT_TRUE(store_->jobs_being_removed()->empty());
  EXPECT_TRUE(store_->begin_removal(pinned)) << "whoever asks for it has it removed";
}

TEST_F(Retention, AClockThatJumpsAYearForwardRemovesNothingForADay) {
  const std::string kept = ended(1, "", R"({"ttl_seconds": 3600})");
  ASSERT_TRUE(send("anna", "v 0 0 0"));
  api::JobOptions soon;
  soon.deadline_ms = {true, now_ms_ + kHourMs};
  const Job waits = submit();
  ASSERT_TRUE(jobs_->change(waits.id, soon, std::nullopt));
  ASSERT_TRUE(jobs_->collect_garbage());
  const auto jump = [&](std::int64_t by_ms) {
    now_ms_ += by_ms;
    jumped_ms_ += by_ms;
  };
  jump(365 * 24 * kHourMs);
  ASSERT_TRUE(jobs_->collect_garbage());
  ASSERT_TRUE(jobs_->fail_overdue());
  EXPECT_TRUE(is_there(kept));
  EXPECT_TRUE(has("anna", "v 0 0 0"));
  EXPECT_EQ(job(waits.id).state, api::JobState::queued);
  const auto claimed = jobs_->claim();
  ASSERT_TRUE(claimed && *claimed);
  EXPECT_EQ(jobs_->wanted((*claimed)->lease), Wanted::go_on);
  jump(-365 * 24 * kHourMs);
  now_ms_ += 2 * kHourMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_FALSE(is_there(kept)) << "the clock is back, and its time is over";
  EXPECT_EQ(jobs_->wanted((*claimed)->lease), Wanted::deadline_passed);
}

TEST_F(Retention, AClockThatStaysWhereItJumpedIsBelievedAfterADay) {
  const std::string kept = ended(1, "", R"({"ttl_seconds": 3600})");
  now_ms_ += 365 * 24 * kHourMs;
  jumped_ms_ += 365 * 24 * kHourMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  now_ms_ += 23 * kHourMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_TRUE(is_there(kept));
  now_ms_ += kHourMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_FALSE(is_there(kept));
}

TEST_F(Retention, ACollectionThatCouldNotRemoveEverythingIsNoSuccess) {
  const std::string id = ended(1, "", R"({"ttl_seconds": 3600})");
  ASSERT_TRUE(jobs_->collect_garbage());
  const std::int64_t before = jobs_->garbage().last_ms;
  EXPECT_EQ(before, now_ms_);
  now_ms_ += 2 * kHourMs;
  auto beside = Database::open(folder_->database());
  ASSERT_TRUE(beside && beside->execute("CREATE TRIGGER refuse BEFORE UPDATE OF removing ON job "
                                        "BEGIN SELECT RAISE(ABORT, 'no'); END"));
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_EQ(jobs_->garbage().last_ms, before);
  ASSERT_TRUE(beside->execute("DROP TRIGGER refuse"));
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_EQ(jobs_->garbage().last_ms, now_ms_);
}

TEST_F(Retention, ABlobIsItsOwnersAndNobodyElseLearnsOfIt) {
  ASSERT_TRUE(send("anna", "v 0 0 0"));
  EXPECT_TRUE(has("anna", "v 0 0 0"));
  EXPECT_FALSE(has("bert", "v 0 0 0"));
  EXPECT_FALSE(has("", "v 0 0 0"));
  const std::string other = sha256_of("never sent");
  const std::string known = sha256_of("v 0 0 0");
  std::string told = jobs_->open_blob("bert", known).error().message;
  EXPECT_EQ(told.replace(told.find(known), known.size(), other),
            jobs_->open_blob("bert", other).error().message);
  ASSERT_TRUE(send("bert", "v 0 0 0"));
  EXPECT_TRUE(has("bert", "v 0 0 0"));
  EXPECT_EQ(*store_->blob_bytes(), 14) << "whoever shares bytes pays for them as if alone";
  EXPECT_EQ(*store_->total_bytes("anna"), 7);
}

TEST_F(Retention, AHashIsNoBlobWithoutTheBytes) {
  ASSERT_TRUE(send("anna", "secret"));
  EXPECT_EQ(send("bert", "a guess", sha256_of("secret")).error().fault, Fault::invalid_request);
  EXPECT_FALSE(has("bert", "secret"));
}

TEST_F(Retention, ABlobGoesWhenItsOwnerHasNotUsedItAndStaysForOthers) {
  ASSERT_TRUE(send("anna", "shared"));
  ASSERT_TRUE(send("bert", "shared"));
  ASSERT_TRUE(send("bert", "old"));
  now_ms_ += 20 * kHourMs;
  EXPECT_TRUE(has("bert", "shared"));
  now_ms_ += 5 * kHourMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_FALSE(has("anna", "shared"));
  EXPECT_TRUE(has("bert", "shared"));
  EXPECT_FALSE(has("bert", "old"));
  EXPECT_FALSE(std::filesystem::exists(file_of("old")));
  now_ms_ += 25 * kHourMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_FALSE(std::filesystem::exists(file_of("shared")));
}

TEST_F(Retention, BlobsOutliveARestartAndWhatHasNoPartnerIsRemovedThen) {
  ASSERT_TRUE(send("anna", "kept"));
  ASSERT_TRUE(send("anna", "lost"));
  std::filesystem::remove(file_of("lost"));
  write_text(file_of("of before there were owners"), "x");
  restart();
  ASSERT_TRUE(jobs_->clean_up());
  EXPECT_TRUE(has("anna", "kept"));
  EXPECT_FALSE(has("anna", "lost"));
  EXPECT_FALSE(std::filesystem::exists(file_of("of before there were owners")));
  EXPECT_EQ(*store_->blob_bytes(), 4) << "what is not there counts for nobody";
}

TEST_F(Retention, BlobsHaveALimitAndCountInQuotas) {
  rules_.blobs.total_bytes = 10;
  rules_.bytes_of_one_owner_max = 300;
  restart();
  ASSERT_TRUE(send("anna", "12345678"));
  const api::Status full = send("bert", "123");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().fault, Fault::over_quota);
  EXPECT_EQ(send("bert", "12345678").error().fault, Fault::over_quota) << "no other answer for what is there";
  ASSERT_TRUE(jobs_->submit(upload_of("anna")));  // 108 bytes by its inputs
  ASSERT_TRUE(jobs_->submit(upload_of("anna")));
  EXPECT_EQ(jobs_->within_quota("anna", 77).error().fault, Fault::over_quota);
  EXPECT_TRUE(jobs_->within_quota("anna", 76));
}

TEST_F(Retention, JobsThatDoNotSayHowLongAreKeptForTheOperatorsTime) {
  rules_.ttl_ms = 10'000;
  restart();
  const std::string silent = ended(1), own = ended(1, "", R"({"ttl_seconds": 99})"),
                    kept = ended(1, "", R"({"ttl_seconds": null})"),
                    pinned = ended(1, "", R"({"pinned": true})");
  EXPECT_EQ(job(silent).settings.ttl_ms, 10'000);
  now_ms_ += 20'000;
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_FALSE(is_there(silent));
  for (const std::string& id : {own, kept, pinned}) EXPECT_TRUE(is_there(id));
}

TEST_F(Retention, WithoutEvictionFullIsFull) {
  rules_.bytes_max = 1000;
  restart();
  const std::string old = ended(950);
  EXPECT_EQ(jobs_->submit(upload_of("")).error().fault, Fault::over_quota);
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_TRUE(is_there(old));
}

TEST_F(Retention, WhatNobodyHasUsedForLongestGoesFirst) {
  rules_.bytes_max = 1000;
  rules_.evict = true;
  restart();
  const std::string oldest = ended(300), second = ended(300), third = ended(300);
  now_ms_ += 2 * 60'000;
  jobs_->use(job(oldest));
  ASSERT_TRUE(jobs_->submit(upload_of("")));
  EXPECT_TRUE(is_there(oldest)) << "somebody has looked at it since";
  EXPECT_FALSE(is_there(second));
  EXPECT_TRUE(is_there(third)) << "no more than needed";
  EXPECT_EQ(jobs_->garbage().evicted_jobs, 1);
  EXPECT_EQ(jobs_->garbage().evicted_bytes, 300);
}

TEST_F(Retention, WhatIsPinnedWaitsOrRunsIsNeverEvicted) {
  rules_.bytes_max = 1000;
  rules_.evict = true;
  restart();
  const std::string pinned = ended(300, "", R"({"pinned": true})");
  const Job running = submit();
  claim();
  ASSERT_TRUE(store_->record_bytes(running.seq, 300));
  const Job waiting = submit();
  ASSERT_TRUE(store_->record_bytes(waiting.seq, 300));
  const auto refused = jobs_->submit(upload_of(""));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::over_quota);
  for (const std::string& id : {pinned, running.id, waiting.id}) EXPECT_TRUE(is_there(id));
  EXPECT_EQ(jobs_->garbage().evicted_jobs, 0);
}

TEST_F(Retention, AnUploadThatIsRefusedCostsNobodyTheirs) {
  rules_.bytes_max = 1000;
  rules_.evict = true;
  restart();
  const std::string old = ended(950);
  EXPECT_TRUE(jobs_->admit("", 500)) << "there will be room";
  EXPECT_EQ(jobs_->admit("", 1001).error().fault, Fault::over_quota);
  check_result_ = api::Error{Fault::invalid_request, "wrong"};
  EXPECT_EQ(jobs_->submit(upload_of("")).error().fault, Fault::invalid_request);
  EXPECT_TRUE(is_there(old));
}

TEST_F(Retention, ResultsThatComeInLaterMakeRoomToo) {
  rules_.bytes_max = 1500;
  rules_.evict = true;
  restart();
  const std::string old = ended(100), young = ended(100);
  for (const std::string& id : {old, young})
    write_text(folder_->job(id) / "artefacts/large", std::string(700, 'x'));
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_FALSE(is_there(old));
  EXPECT_TRUE(is_there(young));
}

TEST_F(Retention, SizesMendThemselves) {
  const std::string id = ended(0);
  write_text(folder_->job(id) / "views/v/0000.png", std::string(5000, 'x'));
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_GT(job(id).bytes, 5000);
  const std::int64_t version = job(id).version;
  ASSERT_TRUE(jobs_->collect_garbage());
  ASSERT_TRUE(jobs_->collect_garbage());
  EXPECT_EQ(job(id).version, version) << "nothing has changed";
}

}  // namespace
}  // namespace server
