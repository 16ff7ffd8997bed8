#include "server/store/maintenance.h"

#include <chrono>
#include <set>
#include <thread>

#include "server/store/migrate.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using namespace std::chrono_literals;

std::int64_t number(Database& database, std::string_view sql) {
  Statement select = database.prepare(sql);
  const std::int64_t value = select.next() ? select.integer(0) : -1;
  EXPECT_TRUE(select.status()) << select.status().error().message;
  return value;
}

/// `megabytes` in rows of a table of its own.
void fill(Database& database, int megabytes) {
  ASSERT_TRUE(database.execute(
      "CREATE TABLE filling(a); WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " +
      std::to_string(megabytes * 256) + ") INSERT INTO filling SELECT hex(randomblob(2000)) FROM n"));
}

TEST(CopyOfADatabase, ComesToItsEndHoweverBusyTheOthersAre) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && database->execute("PRAGMA synchronous=OFF"));
  fill(*database, 100);
  std::atomic<bool> copied = false, given_up = false;
  std::atomic<int> commits = 0;
  std::thread busy([&] {
    const auto enough = std::chrono::steady_clock::now() + 30s;
    while (!copied && !given_up) {
      // Other bytes each time: of the same ones SQLite writes none, and nobody would notice the commit.
      if (database->execute("UPDATE filling SET a = hex(randomblob(2000)) WHERE rowid = 1")) ++commits;
      given_up = std::chrono::steady_clock::now() > enough;
    }
  });
  while (commits < 10) std::this_thread::sleep_for(1ms);
  const int before = commits;
  const api::Status done = copy_database(folder.path() / "db", folder.path() / "copy");
  copied = true;
  busy.join();
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_GT(commits.load(), before) << "nobody had to wait for it";
  EXPECT_FALSE(given_up) << "it did not wait until they were done either";
  auto copy = Database::open(folder.path() / "copy");
  ASSERT_TRUE(copy);
  EXPECT_EQ(number(*copy, "SELECT count(*) FROM filling"), 25600);
}

TEST(Migrations, KeepOneCopyOfWhatWasBefore) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "db";
  const auto names = [&] {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().filename().string().starts_with("db.before")) found.insert(entry.path().filename());
    return found;
  };
  const std::string newest = "db.before-" + std::to_string(migrations().back().number);
  {
    auto database = Database::open(file);
    ASSERT_TRUE(database && migrate_file(*database, file, migrations().first(3)));
    EXPECT_EQ(names(), std::set<std::string>{}) << "a new one has nothing to lose";
    ASSERT_TRUE(migrate_file(*database, file, migrations().first(4)));
    EXPECT_EQ(names(), std::set<std::string>{"db.before-4"});
    write_text(folder.path() / (newest + ".part"), "of a copy that was broken off");
    ASSERT_TRUE(migrate_file(*database, file));
    ASSERT_TRUE(migrate_file(*database, file));
  }
  EXPECT_EQ(names(), std::set<std::string>{newest});
  auto kept = Database::open(folder.path() / newest);
  ASSERT_TRUE(kept);
  EXPECT_EQ(*schema_version(*kept), 4);
}

TEST(Migrations, AreNotBegunWhereNoCopyCanBeKept) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "db";
  auto database = Database::open(file);
  ASSERT_TRUE(database && migrate_file(*database, file, migrations().first(3)));
  std::filesystem::create_directories(folder.path() / ("db.before-4.part") / "in the way");
  EXPECT_FALSE(migrate_file(*database, file, migrations().first(4)));
  EXPECT_EQ(*schema_version(*database), 3);
}

class CopyTest : public ServiceTest {};

TEST_F(CopyTest, KnowsNoWorkersAndBeginsAnew) {
  std::vector<Job> jobs;
  for (int i = 0; i < 4; ++i) jobs.push_back(*jobs_->submit(make_upload()));
  for (int i = 0; i < 3; ++i) {
    const auto claim = store_->claim();
    ASSERT_TRUE(claim && *claim);
    ASSERT_TRUE(store_->record_worker((*claim)->lease, {100 + i, 7, "boot"}));
  }
  ASSERT_TRUE(jobs_->pause(jobs[1].id));
  ASSERT_TRUE(jobs_->cancel(jobs[2].id));
  ASSERT_TRUE(copy_database(folder_->database(), temporary_.path() / "copy"));
  {
    auto copy = Database::open(temporary_.path() / "copy");
    ASSERT_TRUE(copy);
    const api::Status ended = end_attempts_of_copy(*copy, 99);
    ASSERT_TRUE(ended) << ended.error().message;
    ASSERT_TRUE(end_attempts_of_copy(*copy, 100)) << "a second time there is nothing to do";
    EXPECT_EQ(number(*copy, "SELECT count(*) FROM event WHERE reason = 'restored'"), 3);
    EXPECT_EQ(number(*copy,
                     "SELECT count(*) FROM attempt WHERE worker_pid IS NULL AND worker_start_ticks "
                     "IS NULL AND worker_boot_id IS NULL AND ended_ms = 99"),
              3);
    EXPECT_TRUE(check_integrity(*copy));
  }
  const auto copy = JobStore::open(temporary_.path() / "copy");
  ASSERT_TRUE(copy);
  EXPECT_TRUE((*copy)->orphans()->empty());
  const std::vector<api::JobState> expected{api::JobState::queued, api::JobState::paused,
                                            api::JobState::canceled, api::JobState::queued};
  for (std::size_t i = 0; i < jobs.size(); ++i) EXPECT_EQ((*copy)->job(jobs[i].id)->state, expected[i]) << i;
  EXPECT_EQ((*copy)->job(jobs[0].id)->reason, "restored");
  const auto claim = (*copy)->claim();
  ASSERT_TRUE(claim && *claim);
  EXPECT_EQ((*claim)->job.id, jobs[0].id);
  EXPECT_EQ(store_->orphans()->size(), 3u) << "the original is as it was";
}

TEST_F(CopyTest, ADatabaseThatIsDamagedWhileItIsUsedIsNotReady) {
  const auto job = jobs_->submit(make_upload());
  ASSERT_TRUE(job);
  jobs_.reset();
  store_.reset();
  {
    auto database = Database::open(folder_->database());
    ASSERT_TRUE(database);
    // More than SQLite keeps in memory.
    ASSERT_TRUE(database->execute(
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 4000) INSERT INTO "
        "event(job_seq, at_ms, to_state, reason, message) SELECT 1, 0, 'queued', '', hex(randomblob(1000)) "
        "FROM n"));
  }
  auto store = JobStore::open(folder_->database());
  ASSERT_TRUE(store);
  EXPECT_TRUE((*store)->can_write());
  {
    std::fstream file(folder_->database(), std::ios::in | std::ios::out | std::ios::binary);
    const auto bytes = std::filesystem::file_size(folder_->database());
    for (std::uintmax_t at = 4096; at + 4096 <= bytes; at += 4096) {
      file.seekp(static_cast<std::streamoff>(at));
      file << std::string(64, '\xa5');
    }
  }
  ASSERT_FALSE((*store)->events(job->seq)) << "somebody asks for a page that is none";
  const api::Status ready = (*store)->can_write();
  ASSERT_FALSE(ready);
  EXPECT_NE(ready.error().message.find("damaged"), std::string::npos);
}

}  // namespace
}  // namespace server
