// Statements are compiled once and used again; nobody notices but by the time it takes.
#include <gtest/gtest.h>

#include "server/store/database.h"
#include "tests/support/temporary_folder.h"

namespace server {
namespace {

class StatementTest : public testing::Test {
 protected:
  void SetUp() override {
    auto database = Database::open(folder_.path() / "db");
    ASSERT_TRUE(database);
    database_.emplace(std::move(*database));
    ASSERT_TRUE(
        database_->execute("CREATE TABLE t(a INTEGER, b TEXT); INSERT INTO t VALUES (1, 'one'), (2, 'two')"));
  }
  std::string one_of(std::int64_t a) {
    Statement select = database_->prepare("SELECT b FROM t WHERE a = ?");
    return select.bind(a).next() ? select.text(0) : "nothing";
  }

  tests::TemporaryFolder folder_;
  std::optional<Database> database_;
};

TEST_F(StatementTest, ASecondUseKnowsNothingOfTheFirst) {
  EXPECT_EQ(one_of(1), "one");
  EXPECT_EQ(one_of(2), "two");
  Statement unbound = database_->prepare("SELECT b FROM t WHERE a = ?");
  EXPECT_FALSE(unbound.next()) << "the value of the last use is gone";
  EXPECT_TRUE(unbound.status());
}

TEST_F(StatementTest, TwoUsesOfOneTextAtTheSameTimeAreApart) {
  Statement outer = database_->prepare("SELECT b FROM t ORDER BY a");
  ASSERT_TRUE(outer.next());
  {
    Statement inner = database_->prepare("SELECT b FROM t ORDER BY a");
    ASSERT_TRUE(inner.next());
    EXPECT_EQ(inner.text(0), "one");
  }
  ASSERT_TRUE(outer.next());
  EXPECT_EQ(outer.text(0), "two");
}

TEST_F(StatementTest, AStatementThatFailedIsAsGoodAsNew) {
  ASSERT_TRUE(database_->execute("CREATE UNIQUE INDEX only ON t(a)"));
  const auto insert = [&](std::int64_t a) {
    return database_->prepare("INSERT INTO t VALUES (?, 'x')").bind(a).run();
  };
  EXPECT_FALSE(insert(1));
  EXPECT_TRUE(insert(3));
  EXPECT_FALSE(database_->prepare("SELECT nonsense FROM nowhere").run());
}

TEST_F(StatementTest, AUnfinishedOneHoldsNothingOnceItIsGone) {
  { ASSERT_TRUE(database_->prepare("SELECT b FROM t").next()); }
  EXPECT_TRUE(database_->execute("DROP TABLE t")) << "no read is open any more";
  EXPECT_TRUE(database_->execute("CREATE TABLE t(a INTEGER, b TEXT); INSERT INTO t VALUES (1, 'another')"));
  EXPECT_EQ(one_of(1), "another");
}

TEST_F(StatementTest, ThousandsOfTextsAreNotAllKept) {
  for (int i = 0; i < 2000; ++i)
    ASSERT_TRUE(database_->prepare("SELECT " + std::to_string(i) + " FROM t").run());
  EXPECT_EQ(one_of(2), "two");
  database_.reset();  // closes: SQLite would refuse, and keep its lock, with statements left
  auto again = Database::open(folder_.path() / "db");
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->execute("PRAGMA locking_mode=EXCLUSIVE; INSERT INTO t VALUES (4, 'four')"));
}

}  // namespace
}  // namespace server
