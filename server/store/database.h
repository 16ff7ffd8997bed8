// One SQLite connection, opened the only way this service opens one.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string_view>

#include "api/result.h"
#include "server/store/statement.h"

namespace server {

/// Nobody else has business in the file, but who looks into it may take a lock for a moment.
inline constexpr std::chrono::milliseconds kLockPatience{5000};

/// The single read-write connection to a database file. Not safe for use by two threads at once: the owner
/// holds a mutex. One connection only, because SQLite before 3.51.3 can lose pages when two connections write
/// and checkpoint at the same time, and because then nobody ever waits for a lock of another.
class Database {
 public:
  /// Opens or creates `file` and sets, then reads back, every pragma that durability rests on:
  /// journal_mode=WAL, synchronous=FULL, foreign_keys=ON. A setting that did not take is an error: better no
  /// service than a service that loses jobs. Nothing else may ever open(2) that file: closing such a
  /// descriptor would drop SQLite's locks.
  static api::Result<Database> open(const std::filesystem::path& file);

  /// A connection that cannot write, beside the one that does: for what watches while others wait for that
  /// one. The file must exist.
  static api::Result<Database> open_to_read(const std::filesystem::path& file);

  Statement prepare(std::string_view sql) { return Statement(handle_.get(), sql); }

  /// How long a statement waits for a lock of another process; kLockPatience when it was opened.
  void set_patience(std::chrono::milliseconds patience);

  /// One or more statements without values or rows of interest.
  api::Status execute(std::string_view script);

  /// Rows touched by the last statement.
  std::int64_t changes() const;
  std::int64_t last_row() const;
  bool in_transaction() const;
  /// Has SQLite found a page that is none, since this was opened?
  bool damaged() const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  static api::Result<Database> open_file(const std::filesystem::path& file, int flags);

  std::unique_ptr<sqlite3, Close> handle_;
};

/// BEGIN IMMEDIATE ... COMMIT; rolled back when it goes out of scope without a commit.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) {}
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  api::Status begin() { return database_.execute("BEGIN IMMEDIATE"); }
  api::Status commit() { return database_.execute("COMMIT"); }

 private:
  Database& database_;
};

}  // namespace server
