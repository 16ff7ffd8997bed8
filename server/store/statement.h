// A prepared SQLite statement that cleans up after itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "api/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace server {

/// Bind in order, step, read, then ask status(). The first error sticks and makes every later call a no-op,
/// so it is tested once, at the end:
///
///     Statement select = database.prepare("SELECT name FROM job WHERE seq > ?");
///     select.bind(seq);
///     while (select.next()) names.push_back(select.text(0));
///     if (const api::Status ok = select.status(); !ok) return ok.error();
class Statement {
 public:
  Statement(sqlite3* database, std::string_view sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::int64_t value);
  Statement& bind(double value);
  Statement& bind(std::string_view value);
  Statement& bind_null();
  template <class T>
  Statement& bind_optional(const std::optional<T>& value) {
    return value ? bind(*value) : bind_null();
  }

  /// To the next row; false when there is none or something went wrong.
  bool next();
  /// Runs to the end.
  api::Status run();
  /// Ready for the next set of values.
  void reset();

  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  bool is_null(int column) const;
  std::optional<std::int64_t> optional_integer(int column) const;
  std::optional<double> optional_real(int column) const;

  api::Status status() const;

 private:
  void note(int code);

  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
  int error_code_ = 0;
  std::string error_;
};

/// What an SQLite result code means to a caller: disk_full for a full disk, internal otherwise, with
/// SQLite's own words.
api::Error sqlite_error(int code, std::string_view words);

}  // namespace server
