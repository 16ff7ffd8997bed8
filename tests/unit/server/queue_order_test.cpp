// Whose turn it is, and how quickly that is found in a long queue.
#include <algorithm>
#include <chrono>
#include <iostream>

#include "server/store/migrate.h"
#include "server/store/turns.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::JobState;

constexpr std::int64_t kMinuteMs = 60'000;

class QueueOrder : public ServiceTest {
 protected:
  Job submit_as(const std::string& owner, int priority = 50, std::int64_t memory_bytes = 0) {
    Upload upload = make_upload();
    upload.owner = owner;
    upload.options = "{\"priority\": " + std::to_string(priority) + "}";
    if (memory_bytes > 0)
      write_text(folder_->upload(upload.id) / "check.json",
                 R"({"outcome": "succeeded", "message": "", "violations": [], "warnings": [],
                     "stage_seconds": [], "counts": [], "peak_memory_bytes": 1, "forecast": {"polygons": 2,
                     "patches": 30, "frames": 3, "seconds": 0.5, "memory_bytes": )" +
                     std::to_string(memory_bytes) + "}}");
    auto made = jobs_->submit(upload);
    EXPECT_TRUE(made) << made.error().message;
    return made ? *made : Job{};
  }

  /// The owners, or ids, of the next jobs, each finished before the next is taken.
  std::vector<std::string> next_owners(int count) {
    std::vector<std::string> owners;
    for (int i = 0; i < count; ++i) {
      const Claim claimed = claim();
      owners.push_back(claimed.job.owner);
      EXPECT_TRUE(store_->fail(claimed.lease, {"test", ""}, {}, ""));
      now_ms_ += 10;
    }
    return owners;
  }
};

TEST_F(QueueOrder, HigherPriorityGoesFirstAndOlderAmongEqual) {
  const Job old_low = submit_as("", 10);
  const Job first = submit_as("", 50);
  const Job second = submit_as("", 50);
  const Job urgent = submit_as("", 90);
  for (const Job& expected : {urgent, first, second, old_low}) EXPECT_EQ(claim().job.id, expected.id);
}

TEST_F(QueueOrder, AMinuteOfWaitingIsWorthAPoint) {
  const Job low = submit_as("", 10);
  now_ms_ += 39 * kMinuteMs;
  const Job younger = submit_as("", 50);
  now_ms_ += 2 * kMinuteMs;
  const Job youngest = submit_as("", 50);
  EXPECT_EQ(claim().job.id, younger.id) << "39 minutes are not worth 40 points";
  EXPECT_EQ(claim().job.id, low.id) << "41 are";
  EXPECT_EQ(claim().job.id, youngest.id);
}

TEST_F(QueueOrder, AJobOfLowestPriorityIsTakenHoweverManyUrgentOnesCome) {
  const std::string low = submit_as("", 0).id;
  for (int minute = 0; minute <= 101; ++minute) {
    submit_as("", 100);
    const Claim claimed = claim();
    ASSERT_TRUE(store_->fail(claimed.lease, {"test", ""}, {}, ""));
    if (claimed.job.id == low) {
      EXPECT_GE(minute, 100);
      return;
    }
    now_ms_ += kMinuteMs;
  }
  FAIL() << "it starved";
}

TEST_F(QueueOrder, OwnersTakeTurnsHoweverManyJobsOneHas) {
  for (int i = 0; i < 20; ++i) submit_as("flood");
  now_ms_ += 5 * kMinuteMs;
  submit_as("late");
  submit_as("late");
  const auto owners = next_owners(6);
  EXPECT_EQ(std::count(owners.begin(), owners.begin() + 4, "late"), 2) << "the head start does not count";
  EXPECT_EQ(owners[4], "flood");
}

TEST_F(QueueOrder, WhoHasFewerJobsRunningGoesFirst) {
  for (int i = 0; i < 4; ++i) submit_as("many");
  EXPECT_EQ(claim().job.owner, "many");
  EXPECT_EQ(claim().job.owner, "many");
  now_ms_ += 3 * kMinuteMs;
  submit_as("few");
  EXPECT_EQ(claim().job.owner, "few") << "beside two that run";
  EXPECT_EQ(claim().job.owner, "many");
}

TEST_F(QueueOrder, AnOwnerOfUrgentJobsDoesNotStarveAnother) {
  submit_as("patient", 20);
  for (int minute = 0; minute < 60; ++minute) {
    submit_as("urgent", 50);
    const Claim claimed = claim();
    ASSERT_TRUE(store_->fail(claimed.lease, {"test", ""}, {}, ""));
    if (claimed.job.owner == "patient") {
      EXPECT_GE(minute, 29);
      return;
    }
    now_ms_ += kMinuteMs;
  }
  FAIL() << "it starved";
}

TEST_F(QueueOrder, TurnsOutliveARestart) {
  submit_as("a");
  submit_as("a");
  submit_as("b");
  const std::string first = next_owners(1).front();
  restart();
  EXPECT_NE(next_owners(1).front(), first);
}

TEST_F(QueueOrder, PositionsAreTheOrderInWhichJobsAreTaken) {
  std::vector<Job> made;
  for (const int priority : {50, 10, 90, 50, 70}) made.push_back(submit_as("a", priority));
  for (const int priority : {50, 60, 20}) made.push_back(submit_as("b", priority));
  const auto positions = jobs_->queue_positions();
  ASSERT_EQ(positions->size(), made.size());
  for (std::size_t place = 1; place <= made.size(); ++place) {
    const Claim claimed = claim();  // all of them run at once, as positions suppose
    EXPECT_EQ(positions->at(claimed.job.seq), static_cast<std::int64_t>(place));
  }
  EXPECT_TRUE(jobs_->queue_positions()->empty());
}

TEST_F(QueueOrder, AJobThatDoesNotFitIsOvertakenForAWhileAndThenWaitedFor) {
  constexpr std::int64_t kGigabyte = 1 << 30;
  const Job large = submit_as("", 50, 8 * kGigabyte);
  const Job small = submit_as("", 50, kGigabyte);
  const Room room{2 * kGigabyte, false};
  auto claimed = jobs_->claim(room);
  ASSERT_TRUE(claimed && *claimed);
  EXPECT_EQ((*claimed)->job.id, small.id);
  submit_as("", 50, kGigabyte);
  now_ms_ += kOvertakenMaxMs;
  claimed = jobs_->claim(room);
  ASSERT_TRUE(claimed);
  EXPECT_FALSE(claimed->has_value()) << "now the large one has its turn";
  claimed = jobs_->claim({2 * kGigabyte, true});
  ASSERT_TRUE(claimed && *claimed);
  EXPECT_EQ((*claimed)->job.id, large.id) << "alone, when nothing else runs";
}

TEST_F(QueueOrder, APausedQueueGivesNothingAcrossRestarts) {
  submit_as("");
  ASSERT_TRUE(jobs_->pause_queue("maintenance"));
  EXPECT_FALSE(jobs_->claim()->has_value());
  restart();
  EXPECT_FALSE(jobs_->claim()->has_value());
  const auto report = jobs_->queue();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->queue.reason, "maintenance");
  EXPECT_EQ(report->jobs.at(JobState::queued), 1);
  ASSERT_TRUE(jobs_->resume_queue());
  EXPECT_TRUE(jobs_->claim()->has_value());
}

TEST_F(QueueOrder, AClockSetBackByAYearStarvesNobody) {
  constexpr std::int64_t kYearMs = 365LL * 24 * 60 * kMinuteMs;
  now_ms_ += kYearMs;
  submit_as("a");
  const std::string ahead = submit_as("a").id;
  claim();
  now_ms_ -= kYearMs;
  ASSERT_TRUE(store_->mend_times());
  now_ms_ += kMinuteMs;
  submit_as("a");
  EXPECT_EQ(claim().job.id, ahead);
}

TEST_F(QueueOrder, AClockSetBackByAYearKeepsNobodyWaitingForAYear) {
  constexpr std::int64_t kYearMs = 365LL * 24 * 60 * kMinuteMs;
  const std::string id = submit_as("a").id;
  now_ms_ += kYearMs;
  ASSERT_TRUE(jobs_->end_attempt(claim().lease, {OutcomeKind::disk_full, "disk_full", "full", {6, {}}, ""}));
  now_ms_ -= kYearMs;
  ASSERT_TRUE(jobs_->collect_garbage());
  now_ms_ += rules_.disk_full_wait_ms_max;
  const auto claimed = jobs_->claim();
  EXPECT_TRUE(claimed && *claimed);
}

std::string plan_of(Database& database, const std::string& sql) {
  Statement plan = database.prepare("EXPLAIN QUERY PLAN " + sql);
  std::string text;
  while (plan.next()) text += plan.text(3) + "\n";
  EXPECT_TRUE(plan.status()) << plan.status().error().message;
  return text;
}

TEST(QueuePlans, NeitherScanTheQueueNorSortIt) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database));
  const std::string claim = plan_of(
      *database,
      "SELECT seq, rank_ms, queued_ms, memory_bytes FROM job INDEXED BY job_turn WHERE state = 'queued' AND "
      "owner = 'a' AND not_before_ms <= 5 AND memory_bytes <= 5 ORDER BY rank_ms, seq LIMIT 1");
  EXPECT_NE(claim.find("SEARCH job USING INDEX job_turn (owner=?)"), std::string::npos) << claim;
  const std::string urgency =
      plan_of(*database,
              "SELECT max(priority) FROM job INDEXED BY job_urgency WHERE state = 'queued' AND owner = 'a'");
  EXPECT_NE(urgency.find("SEARCH"), std::string::npos) << urgency;
  const std::string list = plan_of(
      *database,
      "SELECT id FROM job WHERE removing = 0 AND seq < 5 AND state = 'queued' ORDER BY seq DESC LIMIT 50");
  EXPECT_NE(list.find("job_by_state"), std::string::npos) << list;
  for (const std::string& plan : {claim, urgency, list}) {
    EXPECT_EQ(plan.find("TEMP B-TREE"), std::string::npos) << plan;
    EXPECT_EQ(plan.find("SCAN"), std::string::npos) << plan;
  }
}

TEST(QueuePlans, CountAndOrderALongQueueWithoutReadingItsJobs) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database));
  const std::string all = "SELECT count(*) FROM job WHERE state = 'queued' AND removing = 0";
  const std::string own =
      "SELECT count(*) FROM job INDEXED BY job_urgency WHERE state = 'queued' AND owner = 'a'";
  const std::string places =
      "SELECT seq, owner, priority, queued_ms FROM job INDEXED BY job_urgency WHERE state = 'queued' "
      "ORDER BY owner, priority, queued_ms, seq";
  for (const std::string& sql : {all, own, places}) {
    const std::string plan = plan_of(*database, sql);
    EXPECT_NE(plan.find("COVERING INDEX"), std::string::npos) << plan;
    EXPECT_EQ(plan.find("TEMP B-TREE"), std::string::npos) << plan;
  }
}

TEST(QueuePlans, ThePointOfTheSchemaIsThatOfTheCode) {
  const TemporaryFolder folder;
  auto database = Database::open(folder.path() / "db");
  ASSERT_TRUE(database && migrate(*database));
  ASSERT_TRUE(database->execute(
      "INSERT INTO job(id, name, state, frame_count, fps, input_bytes, priority, queued_ms, created_ms, "
      "updated_ms) "
      "VALUES ('job_AAAAAAAAAAAAAAAAAAAAAAAAAA', '', 'queued', 1, 24, 0, 7, 1000000, 0, 0)"));
  Statement rank = database->prepare("SELECT rank_ms FROM job");
  ASSERT_TRUE(rank.next());
  EXPECT_EQ(rank.integer(0), rank_ms({1, "", 7, 1'000'000}));
}

// Prints what a long queue costs; the machine's speed is no matter of right and wrong.
TEST_F(QueueOrder, TenThousandJobsInTheQueue) {
  constexpr int kJobs = 10'000;
  constexpr int kOwners = 20;
  // Beside the store and in one transaction: ten thousand commits take their time on a disk.
  auto beside = Database::open(folder_->database());
  ASSERT_TRUE(beside &&
              beside->execute(
                  "WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i + 1 < " +
                  std::to_string(kJobs) +
                  ") INSERT INTO job(id, owner, name, state, priority, frame_count, fps, input_bytes, "
                  "queued_ms, created_ms, updated_ms) SELECT 'job_' || printf('%026d', i), 'owner' || (i % " +
                  std::to_string(kOwners) + "), '', 'queued', i * 37 % 101, 3, 24, 0, " +
                  std::to_string(now_ms_.load()) + " + i, 0, 0 FROM n"));
  const auto milliseconds_of = [](auto act) {
    const auto begun = std::chrono::steady_clock::now();
    act();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
  };
  std::vector<double> claims;
  std::int64_t last_seq = 0;
  for (int i = 0; i < 1000; ++i)
    claims.push_back(milliseconds_of([&] {
      const auto claimed = jobs_->claim();
      ASSERT_TRUE(claimed && *claimed);
      last_seq = (*claimed)->lease.job_seq;
    }));
  std::sort(claims.begin(), claims.end());
  std::vector<double> commits;  // what the disk alone takes
  for (int i = 0; i < 200; ++i)
    commits.push_back(milliseconds_of([&] { ASSERT_TRUE(store_->record_bytes(last_seq, i)); }));
  std::sort(commits.begin(), commits.end());
  const double page = milliseconds_of([&] { EXPECT_EQ(jobs_->list({}, 200)->jobs.size(), 200u); });
  const double of_state =
      milliseconds_of([&] { EXPECT_EQ(jobs_->list({.state = JobState::queued}, 200)->jobs.size(), 200u); });
  const double places = milliseconds_of([&] { EXPECT_EQ(jobs_->queue_positions()->size(), 9000u); });
  const double again = milliseconds_of([&] { EXPECT_EQ(jobs_->queue_positions()->size(), 9000u); });
  const double counts = milliseconds_of([&] { EXPECT_EQ(jobs_->queue()->jobs.at(JobState::running), 1000); });
  std::cout << "claim p50 " << claims[500] << " ms, p99 " << claims[990] << " ms (a commit alone "
            << commits[100] << ", " << commits[198] << " ms); list of 200 " << page << " ms, of one state "
            << of_state << " ms; positions " << places << " ms, then " << again << " ms; counts " << counts
            << " ms\n";
  RecordProperty("claim_p99_ms", std::to_string(claims[990]));
}

}  // namespace
}  // namespace server
