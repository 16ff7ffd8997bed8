#include "server/store/migrate.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::JobState;

TEST(Migrations, AreNumberedWithoutGapsAndApplyOnce) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database);
  for (std::size_t i = 0; i < migrations().size(); ++i)
    EXPECT_EQ(migrations()[i].number, static_cast<int>(i) + 1) << migrations()[i].name;
  ASSERT_TRUE(migrate(*database));
  ASSERT_TRUE(migrate(*database)) << "a second run has nothing to do";
  EXPECT_EQ(*schema_version(*database), migrations().back().number);
  EXPECT_TRUE(check_integrity(*database));
}

TEST(Migrations, KeyFramesOfEarlierJobsAreCountedAnew) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database, migrations().first(1)));
  ASSERT_TRUE(database->execute(
      "INSERT INTO job(seq, id, name, state, frame_count, fps, input_bytes, key_frame_count, created_ms, "
      "updated_ms) VALUES (1, 'job_aaaaaaaaaaaaaaaaaaaaaaaaaa', '', 'queued', 3, 24, 1, 2, 0, 0), "
      "(2, 'job_bbbbbbbbbbbbbbbbbbbbbbbbbb', '', 'queued', 3, 24, 1, NULL, 0, 0);"
      "INSERT INTO frame(job_seq, frame, kind) VALUES (1, 0, 'key'), (1, 1, 'interpolated')"));
  ASSERT_TRUE(database->execute("INSERT INTO frame(job_seq, frame, kind) VALUES (1, 2, 'check')"));
  ASSERT_TRUE(migrate(*database));
  Statement counts = database->prepare("SELECT key_frame_count, solved_frame_count FROM job ORDER BY seq");
  ASSERT_TRUE(counts.next());
  EXPECT_EQ(counts.optional_integer(0), 1);
  EXPECT_EQ(counts.optional_integer(1), 2);
  ASSERT_TRUE(counts.next());
  EXPECT_TRUE(counts.is_null(0) && counts.is_null(1));
}

TEST(Migrations, JobsOfEarlierVersionsKeepWhatBelongsToThem) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database, migrations().first(3)));
  ASSERT_TRUE(database->execute(
      "INSERT INTO job(seq, id, name, state, frame_count, fps, input_bytes, created_ms, updated_ms) VALUES "
      "(1, 'job_aaaaaaaaaaaaaaaaaaaaaaaaaa', 'old', 'queued', 3, 24, 7, 5, 6), "
      "(2, 'job_bbbbbbbbbbbbbbbbbbbbbbbbbb', '', 'queued', 3, 24, 1, 0, 0);"
      "INSERT INTO event(job_seq, at_ms, to_state, reason, message) VALUES (1, 5, 'queued', 'submitted', '');"
      "INSERT INTO attempt(job_seq, number, lease, started_ms) VALUES (1, 1, 1, 5);"
      "INSERT INTO job_input VALUES (1, 'scene.obj', 'scene', 7);"
      "DELETE FROM job WHERE seq = 2"));
  ASSERT_TRUE(migrate(*database));
  ASSERT_TRUE(check_integrity(*database));
  Statement job = database->prepare(
      "SELECT name, owner, priority, queued_ms, bytes, (SELECT count(*) FROM event), (SELECT count(*) FROM "
      "attempt), (SELECT count(*) FROM job_input) FROM job");
  ASSERT_TRUE(job.next());
  EXPECT_EQ(job.text(0), "old");
  EXPECT_EQ(job.text(1), "");
  EXPECT_EQ(job.integer(2), 50);
  EXPECT_EQ(job.integer(3), 5) << "it has been waiting since it was submitted";
  EXPECT_EQ(job.integer(4), 7);
  for (const int column : {5, 6, 7}) EXPECT_EQ(job.integer(column), 1) << column;
  ASSERT_TRUE(database->execute(
      "INSERT INTO job(id, name, state, frame_count, fps, input_bytes, queued_ms, created_ms, updated_ms) "
      "VALUES ('job_cccccccccccccccccccccccccc', '', 'queued', 3, 24, 1, 0, 0, 0)"));
  EXPECT_EQ(database->last_row(), 3) << "the number of a job that is gone does not come back";
  ASSERT_TRUE(database->execute("DELETE FROM job WHERE seq = 1"));
  Statement left = database->prepare("SELECT count(*) FROM event");
  ASSERT_TRUE(left.next());
  EXPECT_EQ(left.integer(0), 0) << "what belongs to a job goes with it, as before";
}

TEST(Migrations, RefuseASchemaNewerThanThisBuild) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database));
  ASSERT_TRUE(database->execute("PRAGMA user_version=999"));
  const api::Status status = migrate(*database);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("999"), std::string::npos) << status.error().message;
}

TEST(Migrations, RefuseTheFileOfAnotherApplication) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && database->execute("CREATE TABLE somebody_elses(a)"));
  EXPECT_FALSE(migrate(*database));
}

TEST(Migrations, LeaveNothingOfOneThatFails) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  const Migration broken[]{
      {1, "0001_broken.sql", "CREATE TABLE a(x INTEGER) STRICT; INSERT INTO a VALUES ('text')"}};
  ASSERT_TRUE(database);
  EXPECT_FALSE(migrate(*database, broken));
  Statement tables = database->prepare("SELECT count(*) FROM sqlite_schema");
  ASSERT_TRUE(tables.next());
  EXPECT_EQ(tables.integer(0), 0);
  EXPECT_EQ(*schema_version(*database), 0);
}

TEST(Database, SaysSoWhenTheFileIsNoDatabase) {
  const TemporaryFolder folder;
  write_text(folder.path() / "db", std::string(8192, 'x'));
  const auto store = JobStore::open(folder.path() / "db");
  ASSERT_FALSE(store);
  EXPECT_EQ(read_text(folder.path() / "db").size(), 8192u) << "and leaves it as it is";
}

/// Puts a job into `state` past all rules, then asks the database to step.
bool database_allows(Database& database, std::string_view from, std::string_view to) {
  EXPECT_TRUE(database.execute("DROP TRIGGER job_starts_queued"));
  const bool final = from == "succeeded" || from == "failed" || from == "canceled";
  Statement insert = database.prepare(
      "INSERT INTO job(id, name, state, frame_count, fps, input_bytes, queued_ms, created_ms, updated_ms, "
      "finished_ms) VALUES ('job_' || ?, '', ?, 1, 24, 0, 0, 0, 0, ?)");
  insert.bind(std::string(26, 'A'))
      .bind(from)
      .bind_optional(final ? std::optional<std::int64_t>(1) : std::nullopt);
  EXPECT_TRUE(insert.run());
  const bool to_final = to == "succeeded" || to == "failed" || to == "canceled";
  Statement step = database.prepare("UPDATE job SET state = ?, finished_ms = ?");
  step.bind(to).bind_optional(to_final ? std::optional<std::int64_t>(1) : std::nullopt);
  return bool(step.run());
}

TEST(JobSteps, AreTheSameInTheDatabaseAndInTheContract) {
  for (const JobState from : api::kJobStates)
    for (const JobState to : api::kJobStates) {
      const TemporaryFolder folder;
      auto database = Database::open(folder.path() / "db");
      ASSERT_TRUE(database && migrate(*database));
      EXPECT_EQ(database_allows(*database, api::name_of(from), api::name_of(to)), api::may_step(from, to))
          << api::name_of(from) << " -> " << api::name_of(to);
    }
}

TEST(JobSteps, AStateThatTheContractDoesNotKnowIsRefused) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database));
  EXPECT_FALSE(database_allows(*database, "queued", "forgotten"));
}

TEST(ArtefactPaths, AreTheSameForTheDatabaseAsForFiles) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database));
  Statement job = database->prepare(
      "INSERT INTO job(id, name, state, frame_count, fps, input_bytes, queued_ms, created_ms, updated_ms) "
      "VALUES (?, '', 'queued', 1, 24, 0, 0, 0, 0)");
  ASSERT_TRUE(job.bind("job_" + std::string(26, 'A')).run());
  for (const std::string& path : {std::string("a"),
                                  std::string("images/a..b/0000.png"),
                                  std::string("..a/b.."),
                                  std::string("..."),
                                  std::string("h\xC3\xA4user/1"),
                                  std::string(512, 'a'),
                                  std::string("a*[b]?"),
                                  std::string(""),
                                  std::string("/a"),
                                  std::string("a/"),
                                  std::string("a//b"),
                                  std::string("."),
                                  std::string("./a"),
                                  std::string("a/."),
                                  std::string(".."),
                                  std::string("../a"),
                                  std::string("a/../b"),
                                  std::string("a/.."),
                                  std::string("a\\b"),
                                  std::string("a\nb"),
                                  std::string("\x01"),
                                  std::string("\x1f"),
                                  std::string("\x7f"),
                                  std::string(513, 'a')}) {
    Statement row = database->prepare("INSERT INTO artefact VALUES (1, ?, 'image/png', 0, ?)");
    EXPECT_EQ(bool(row.bind(path).bind(std::string(64, '0')).run()), is_plain_relative_path(path)) << path;
  }
}

using StoreTest = ServiceTest;

TEST_F(StoreTest, ClaimsInOrderOfSubmissionAndOnlyWhatIsQueued) {
  const Job first = submit();
  const Job second = submit();
  ASSERT_TRUE(jobs_->cancel(first.id));
  const Job third = submit();
  EXPECT_EQ(claim().job.id, second.id);
  EXPECT_EQ(claim().job.id, third.id);
  const auto nothing = jobs_->claim();
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->has_value());
}

TEST_F(StoreTest, AnOldLeaseCanWriteNothingOnceAnotherAttemptHasBegun) {
  const Job submitted = submit();
  const Claim old = claim();
  ASSERT_TRUE(store_->requeue(old.lease, {"worker_crashed", ""}, {}, true));
  const Claim now = claim();
  ASSERT_EQ(now.job.id, submitted.id);
  const auto is_superseded = [](const auto& result) {
    return !result && result.error().fault == api::Fault::wrong_state;
  };
  EXPECT_TRUE(is_superseded(store_->record_progress(old.lease, {api::Stage::solve, 0.5, 0.9, ""})));
  EXPECT_TRUE(is_superseded(store_->record_worker(old.lease, {1, 1, "boot"})));
  EXPECT_TRUE(is_superseded(store_->succeed(old.lease, {}, "")));
  EXPECT_TRUE(is_superseded(store_->fail(old.lease, {"x", "y"}, {}, "")));
  EXPECT_TRUE(is_superseded(store_->requeue(old.lease, {"x", "y"}, {}, true)));
  EXPECT_TRUE(is_superseded(store_->finish_cancel(old.lease, {})));
  EXPECT_EQ(job(submitted.id).state, JobState::running);
  EXPECT_EQ(job(submitted.id).fraction, 0);
}

TEST_F(StoreTest, EveryStepLeavesAnEventAndRaisesTheVersion) {
  const Job submitted = submit();
  const Claim claimed = claim();
  ASSERT_TRUE(store_->requeue(claimed.lease, {"worker_crashed", "SIGSEGV"}, {std::nullopt, 11}, true));
  const auto events = store_->events(submitted.seq);
  ASSERT_TRUE(events);
  ASSERT_EQ(events->size(), 3u);
  EXPECT_FALSE((*events)[0].from.has_value());
  EXPECT_EQ((*events)[1].to, JobState::running);
  EXPECT_EQ((*events)[2].from, JobState::running);
  EXPECT_EQ((*events)[2].to, JobState::queued);
  EXPECT_EQ((*events)[2].reason, "worker_crashed");
  EXPECT_GT(job(submitted.id).version, claimed.job.version);
  const auto attempts = store_->attempts(submitted.seq);
  ASSERT_TRUE(attempts);
  ASSERT_EQ(attempts->size(), 1u);
  EXPECT_EQ(attempts->front().end.signal, 11);
  EXPECT_EQ(attempts->front().outcome, "worker_crashed");
}

TEST_F(StoreTest, ResultsComeWithTheStepToSucceededOrNotAtAll) {
  const Job submitted = submit();
  const Claim claimed = claim();
  Results results;
  results.artefacts = {{"radiosity.npy", "application/x-npy", 5, std::string(64, 'a')},
                       {"radiosity.npy", "application/x-npy", 5, std::string(64, 'b')}};
  EXPECT_FALSE(store_->succeed(claimed.lease, results, "")) << "one path twice";
  EXPECT_EQ(job(submitted.id).state, JobState::running);
  EXPECT_TRUE(store_->artefacts(submitted.seq)->empty());

  results.artefacts.pop_back();
  results.key_frames.frames = {{0, api::FrameKind::key, 0.0},
                               {1, api::FrameKind::interpolated, std::nullopt},
                               {2, api::FrameKind::check, 0.0}};
  results.key_frames.intervals = {{0, 2, 0.01, 0.02}};
  ASSERT_TRUE(store_->succeed(claimed.lease, results, "{}"));
  EXPECT_EQ(job(submitted.id).key_frame_count, 1u);
  EXPECT_EQ(job(submitted.id).solved_frame_count, 2u);
  const auto frames = store_->frames(submitted.seq);
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 3u);
  EXPECT_EQ((*frames)[1].kind, api::FrameKind::interpolated);
  EXPECT_FALSE((*frames)[1].error.has_value());
  EXPECT_EQ((*frames)[2].kind, api::FrameKind::check);
}

TEST_F(StoreTest, PagesNeitherSkipNorRepeatWhileJobsComeAndGo) {
  std::vector<std::string> submitted;
  for (int i = 0; i < 7; ++i) submitted.push_back(submit().id);
  auto page = jobs_->list({}, 3);
  ASSERT_TRUE(page);
  std::vector<std::string> seen;
  while (true) {
    for (const Job& job : page->jobs) seen.push_back(job.id);
    if (!page->next) break;
    submit();  // a newer one must not shift the older pages
    page = jobs_->list({.before_seq = page->next}, 3);
    ASSERT_TRUE(page);
  }
  EXPECT_EQ(seen, std::vector<std::string>(submitted.rbegin(), submitted.rend()));
}

TEST_F(StoreTest, TheLastFullPageSaysThatItIsTheLast) {
  for (int i = 0; i < 3; ++i) submit();
  const auto page = jobs_->list({}, 3);
  ASSERT_TRUE(page);
  EXPECT_EQ(page->jobs.size(), 3u);
  EXPECT_FALSE(page->next.has_value());
}

TEST_F(StoreTest, ListsOneStateAlone) {
  const Job canceled = submit();
  submit();
  ASSERT_TRUE(jobs_->cancel(canceled.id));
  const auto page = jobs_->list({.state = JobState::canceled}, 10);
  ASSERT_TRUE(page);
  ASSERT_EQ(page->jobs.size(), 1u);
  EXPECT_EQ(page->jobs[0].id, canceled.id);
}

}  // namespace
}  // namespace server
