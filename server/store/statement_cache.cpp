#include "server/store/statement_cache.h"

#include <sqlite3.h>

#include <list>
#include <map>
#include <mutex>
#include <set>
#include <utility>

namespace server {
namespace {

// The service has about a hundred texts; those of the list vary with the filters that clients think of.
constexpr std::size_t kKeptMax = 150;

struct KeptStatement {
  std::string_view sql;  ///< SQLite's own copy
  sqlite3_stmt* statement;
};

/// Of one connection, the one that was given back last first.
using Kept = std::list<KeptStatement>;

std::mutex mutex;
std::map<sqlite3*, Kept> kept_of;
std::set<sqlite3*> damaged;

sqlite3_stmt* kept_statement(sqlite3* database, std::string_view sql) {
  const std::lock_guard lock(mutex);
  Kept& own = kept_of[database];
  for (auto at = own.begin(); at != own.end(); ++at)
    if (at->sql == sql) {
      sqlite3_stmt* statement = at->statement;
      own.erase(at);
      return statement;
    }
  return nullptr;
}

}  // namespace

sqlite3_stmt* take_statement(sqlite3* database, std::string_view sql, int& code) {
  code = SQLITE_OK;
  sqlite3_stmt* statement = kept_statement(database, sql);
  if (!statement)
    code = sqlite3_prepare_v3(database, sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                              &statement, nullptr);
  return statement;
}

void give_back_statement(sqlite3* database, sqlite3_stmt* statement) {
  if (!statement) return;
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  sqlite3_stmt* oldest = nullptr;
  {
    const std::lock_guard lock(mutex);
    Kept& own = kept_of[database];
    own.push_front({sqlite3_sql(statement), statement});
    if (own.size() > kKeptMax) {
      oldest = own.back().statement;
      own.pop_back();
    }
  }
  sqlite3_finalize(oldest);
}

void note_damage(sqlite3* database, int code) {
  if ((code & 0xff) != SQLITE_CORRUPT && (code & 0xff) != SQLITE_NOTADB) return;
  const std::lock_guard lock(mutex);
  damaged.insert(database);
}

bool is_damaged(sqlite3* database) {
  const std::lock_guard lock(mutex);
  return damaged.contains(database);
}

void forget_statements(sqlite3* database) {
  Kept own;
  {
    const std::lock_guard lock(mutex);
    damaged.erase(database);
    if (const auto found = kept_of.find(database); found != kept_of.end()) {
      own = std::move(found->second);
      kept_of.erase(found);
    }
  }
  for (const KeptStatement& each : own) sqlite3_finalize(each.statement);
}

}  // namespace server
