#include "server/store/database.h"

#include <sqlite3.h>

#include <string>

#include "server/store/statement_cache.h"

namespace server {
namespace {

constexpr int kOldestSqlite = 3037000;  // STRICT tables
constexpr int kLongestValueBytes = 16 << 20;

struct Pragma {
  const char* name;
  const char* value;
  const char* expected;  ///< what reading it back must say
};

constexpr Pragma kPragmas[]{
    {"journal_mode", "WAL", "wal"},
    {"synchronous", "FULL", "2"},  // a 202 must survive a power cut
    {"foreign_keys", "ON", "1"},
    {"busy_timeout", "5000", "5000"},
    {"journal_size_limit", "67108864", "67108864"},  // the WAL shrinks again after a burst
    {"wal_autocheckpoint", "1000", "1000"},
    {"trusted_schema", "OFF", "0"},
    {"cell_size_check", "ON", "1"},
    {"mmap_size", "0", "0"},  // a read error is an error code, not SIGBUS
};

constexpr Pragma kReadPragmas[]{
    {"query_only", "ON", "1"},      {"busy_timeout", "5000", "5000"}, {"trusted_schema", "OFF", "0"},
    {"cell_size_check", "ON", "1"}, {"mmap_size", "0", "0"},
};

api::Status set_pragma(Database& database, const Pragma& pragma) {
  const std::string name = pragma.name;
  if (api::Status set = database.execute("PRAGMA " + name + "=" + pragma.value); !set) return set;
  Statement read = database.prepare("PRAGMA " + name);
  const std::string found = read.next() ? read.text(0) : "nothing";
  if (const api::Status ok = read.status(); !ok) return ok;
  if (found != pragma.expected)
    return api::Error{api::Fault::internal,
                      "database: " + name + " should be " + pragma.expected + " but is " + found};
  return api::Done{};
}

void harden(sqlite3* handle) {
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DQS_DDL, 0, nullptr);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kLongestValueBytes);
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const {
  forget_statements(handle);
  sqlite3_close(handle);
}

api::Result<Database> Database::open_file(const std::filesystem::path& file, int flags) {
  if (sqlite3_libversion_number() < kOldestSqlite)
    return api::Error{api::Fault::internal,
                      "SQLite 3.37 or newer is needed, this is " + std::string(sqlite3_libversion())};
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database;
  database.handle_.reset(handle);
  if (code != SQLITE_OK)
    return sqlite_error(code, file.string() + ": " + (handle ? sqlite3_errmsg(handle) : "no memory"));
  harden(handle);
  return database;
}

api::Result<Database> Database::open(const std::filesystem::path& file) {
  auto database = open_file(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  if (!database) return database;
  for (const Pragma& pragma : kPragmas)
    if (const api::Status set = set_pragma(*database, pragma); !set) return set.error();
  return database;
}

api::Result<Database> Database::open_to_read(const std::filesystem::path& file) {
  auto database = open_file(file, SQLITE_OPEN_READONLY);
  if (!database) return database;
  for (const Pragma& pragma : kReadPragmas)
    if (const api::Status set = set_pragma(*database, pragma); !set) return set.error();
  return database;
}

void Database::set_patience(std::chrono::milliseconds patience) {
  sqlite3_busy_timeout(handle_.get(), static_cast<int>(patience.count()));
}

api::Status Database::execute(std::string_view script) {
  const std::string text(script);
  const int code = sqlite3_exec(handle_.get(), text.c_str(), nullptr, nullptr, nullptr);
  if (code == SQLITE_OK) return api::Done{};
  note_damage(handle_.get(), code);
  return sqlite_error(code, sqlite3_errmsg(handle_.get()));
}

bool Database::damaged() const {
  return is_damaged(handle_.get());
}

std::int64_t Database::changes() const {
  return sqlite3_changes64(handle_.get());
}

std::int64_t Database::last_row() const {
  return sqlite3_last_insert_rowid(handle_.get());
}

bool Database::in_transaction() const {
  return sqlite3_get_autocommit(handle_.get()) == 0;
}

Transaction::~Transaction() {
  // SQLite rolls back by itself on a full disk; a second ROLLBACK would only hide the first error.
  if (database_.in_transaction()) (void)database_.execute("ROLLBACK");
}

}  // namespace server
