#include "server/store/statement.h"

#include <sqlite3.h>

#include <utility>

#include "server/store/statement_cache.h"

namespace server {

Statement::Statement(sqlite3* database, std::string_view sql) : database_(database) {
  int code = SQLITE_OK;
  statement_ = take_statement(database_, sql, code);
  note(code);
}

Statement::~Statement() {
  give_back_statement(database_, statement_);
}

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_),
      statement_(std::exchange(other.statement_, nullptr)),
      bound_(other.bound_),
      error_code_(other.error_code_),
      error_(std::move(other.error_)) {}

Statement& Statement::bind(std::int64_t value) {
  if (error_code_ == SQLITE_OK) note(sqlite3_bind_int64(statement_, ++bound_, value));
  return *this;
}

Statement& Statement::bind(double value) {
  if (error_code_ == SQLITE_OK) note(sqlite3_bind_double(statement_, ++bound_, value));
  return *this;
}

Statement& Statement::bind(std::string_view value) {
  // A null pointer would bind NULL, not the empty text.
  const char* text = value.data() ? value.data() : "";
  if (error_code_ == SQLITE_OK)
    note(sqlite3_bind_text64(statement_, ++bound_, text, value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind_null() {
  if (error_code_ == SQLITE_OK) note(sqlite3_bind_null(statement_, ++bound_));
  return *this;
}

bool Statement::next() {
  if (error_code_ != SQLITE_OK) return false;
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) note(code);
  return false;
}

api::Status Statement::run() {
  while (next()) {
  }
  return status();
}

void Statement::reset() {
  if (error_code_ != SQLITE_OK) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
  bound_ = 0;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Statement::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

std::string Statement::text(int column) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  const int size = sqlite3_column_bytes(statement_, column);
  return bytes ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

std::optional<std::int64_t> Statement::optional_integer(int column) const {
  if (is_null(column)) return std::nullopt;
  return integer(column);
}

std::optional<double> Statement::optional_real(int column) const {
  if (is_null(column)) return std::nullopt;
  return real(column);
}

api::Status Statement::status() const {
  if (error_code_ == SQLITE_OK) return api::Done{};
  return sqlite_error(error_code_, error_);
}

void Statement::note(int code) {
  if (code == SQLITE_OK) return;
  error_code_ = code;
  error_ = sqlite3_errmsg(database_);
  note_damage(database_, code);
}

api::Error sqlite_error(int code, std::string_view words) {
  const api::Fault fault = (code & 0xff) == SQLITE_FULL ? api::Fault::disk_full : api::Fault::internal;
  return {fault, "database: " + std::string(words) + " (" + std::to_string(code) + ")"};
}

}  // namespace server
