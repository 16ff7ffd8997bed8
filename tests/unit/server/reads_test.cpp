// Reading has connections of its own: it waits for nobody who writes, and is told of all that was written.
#include <thread>
#include <vector>

#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

/// Another program with the database open, whose lock keeps everybody from writing, as a disk does that
/// stalls.
class Holder {
 public:
  explicit Holder(const std::filesystem::path& file) : database_(std::move(*Database::open(file))) {
    EXPECT_TRUE(database_.execute("BEGIN IMMEDIATE"));
  }
  void let_go() { EXPECT_TRUE(database_.execute("ROLLBACK")); }

 private:
  Database database_;
};

class ReadsTest : public ServiceTest {
 protected:
  Job finished() {
    submit();
    const Claim claimed = claim();
    EXPECT_TRUE(store_->succeed(claimed.lease,
                                {{{"report.json", "application/json", 2, std::string(64, 'c')}}, {}}, "{}"));
    return job(claimed.job.id);
  }

  /// Every way to read that requests take.
  void read_all(const Job& one) {
    EXPECT_TRUE(store_->job(one.id));
    EXPECT_TRUE(store_->owner_of(one.id));
    EXPECT_TRUE(store_->list({}, 10));
    EXPECT_TRUE(store_->count(api::JobState::succeeded));
    EXPECT_TRUE(store_->admit("", 1, {1000, 1000, 1'000'000'000, 1'000'000'000}));
    EXPECT_TRUE(store_->queue());
    EXPECT_TRUE(store_->counts());
    EXPECT_TRUE(store_->waiting());
    EXPECT_TRUE(store_->owner_turns());
    EXPECT_TRUE(store_->inputs(one.seq));
    EXPECT_TRUE(store_->attempts(one.seq));
    EXPECT_TRUE(store_->events(one.seq));
    EXPECT_TRUE(store_->artefacts(one.seq));
    EXPECT_TRUE(store_->artefact(one.seq, "report.json"));
    EXPECT_TRUE(store_->frames(one.seq));
    EXPECT_TRUE(store_->must_be_whole(one.seq, "*"));
    EXPECT_TRUE(store_->count_damaged());
    EXPECT_TRUE(store_->integrity());
    EXPECT_TRUE(store_->total_bytes());
    EXPECT_TRUE(store_->blob_bytes());
    EXPECT_TRUE(store_->job_of_key("", "key", 0));
    EXPECT_TRUE(store_->use_blob("", std::string(64, 'a')));
    EXPECT_EQ(store_->leased_job({one.seq, 99}).error().fault, api::Fault::wrong_state);
    store_->record_use(one.seq);
  }
};

TEST_F(ReadsTest, WhoReadsDoesNotWaitForWhoWrites) {
  const Job one = finished();
  ASSERT_TRUE(store_->keep_blob("", std::string(64, 'a'), 1));
  now_ms_ += 24 * 3'600'000;  // its use is to be noted
  Holder holder(folder_->database());
  std::atomic<bool> written = false;
  std::thread writer([&] {
    EXPECT_TRUE(store_->record_bytes(one.seq, 77));
    written = true;
  });
  // It holds the store's connection once a question whether one can write is answered without asking the
  // file.
  while (!store_->can_write()) std::this_thread::yield();
  read_all(one);
  EXPECT_FALSE(written) << "all of that waited for the write";
  holder.let_go();
  writer.join();
  EXPECT_EQ(job(one.id).bytes, 77) << "what was written is read at once";
}

TEST_F(ReadsTest, ThatNobodyCanWriteIsSaidWithoutWaitingForIt) {
  Holder holder(folder_->database());
  std::thread late([&] {
    std::this_thread::sleep_for(kLockPatience / 2);
    holder.let_go();
  });
  // Whoever waited for the lock would get it.
  EXPECT_FALSE(store_->can_write());
  late.join();
  EXPECT_TRUE(store_->can_write());
}

TEST_F(ReadsTest, WhatIsReadTogetherIsOfOneMoment) {
  const Job one = submit();
  const auto pool = ReadPool::open(folder_->database(), 2);
  ASSERT_TRUE(pool);
  const auto name_in = [](Reading& reading) {
    Statement select = reading.prepare("SELECT name FROM job");
    return select.next() ? select.text(0) : "none";
  };
  api::JobOptions options;
  options.name = "later";
  {
    Reading before(**pool);
    EXPECT_EQ(name_in(before), "");
    ASSERT_TRUE(store_->change(one.id, options, {}));
    EXPECT_EQ(name_in(before), "");
    std::thread([&] {
      Reading after(**pool);
      EXPECT_EQ(name_in(after), "later");
    }).join();
  }
  Reading again(**pool);
  EXPECT_EQ(name_in(again), "later");
}

TEST_F(ReadsTest, MoreReadersThanConnectionsTakeTurns) {
  const Job one = finished();
  std::atomic<int> read = 0;
  std::vector<std::thread> readers;
  for (int i = 0; i < 32; ++i)
    readers.emplace_back([&] {
      for (int k = 0; k < 50; ++k) read += store_->job(one.id) && store_->list({}, 10) ? 1 : 0;
    });
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(store_->record_bytes(one.seq, i));
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(read, 32 * 50);
}

TEST_F(ReadsTest, ReadingAllTheTimeDoesNotMakeTheLogGrow) {
  const Job one = finished();
  std::atomic<bool> over = false;
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i)
    readers.emplace_back([&] {
      while (!over) EXPECT_TRUE(store_->list({}, 10));
    });
  constexpr int kCommits = 3000;  // of two pages and more
  for (int i = 0; i < kCommits; ++i) ASSERT_TRUE(store_->record_bytes(one.seq, i));
  over = true;
  for (std::thread& reader : readers) reader.join();
  const auto bytes = std::filesystem::file_size(folder_->database().string() + "-wal");
  EXPECT_LT(bytes, std::uintmax_t{kCommits} * 4096) << "nothing of it was used again";
}

TEST_F(ReadsTest, AUseCountsAtOnceAndIsWrittenLater) {
  const Job first = finished(), second = finished();
  now_ms_ += 1000;
  store_->record_use(first.seq);
  EXPECT_EQ(job(first.id).used_ms, 0);
  const auto unused = store_->least_used(2);
  ASSERT_TRUE(unused && unused->size() == 2);
  EXPECT_EQ((*unused)[0].id, second.id) << "whoever makes room knows of it";

  now_ms_ += 1000;
  store_->record_use(second.seq);
  ASSERT_TRUE(store_->keep_uses());
  EXPECT_EQ(job(second.id).used_ms, now_ms_);
  now_ms_ += 1000;
  store_->record_use(first.seq);
  restart();
  EXPECT_EQ(job(first.id).used_ms, now_ms_) << "nor does a stop forget it";
}

TEST_F(ReadsTest, ABlobThatWasJustAskedForIsNotForgotten) {
  const std::string hash(64, 'b');
  ASSERT_TRUE(store_->keep_blob("anna", hash, 10));
  now_ms_ += 24 * 3'600'000;
  EXPECT_TRUE(*store_->use_blob("anna", hash));
  EXPECT_FALSE(*store_->use_blob("bert", hash));
  EXPECT_EQ(*store_->forget_blobs(now_ms_ - 1), 0);
  EXPECT_EQ(*store_->forget_blobs(now_ms_), 1);
}

TEST_F(ReadsTest, WhatCouldNotBeWrittenIsNotLost) {
  const Job one = finished();
  store_->record_use(one.seq);
  Holder holder(folder_->database());
  EXPECT_FALSE(store_->keep_uses());
  holder.let_go();
  EXPECT_TRUE(store_->keep_uses());
  EXPECT_EQ(job(one.id).used_ms, now_ms_);
}

}  // namespace
}  // namespace server
