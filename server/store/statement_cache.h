// Compiled statements, kept for the next use of the same text: compiling one takes longer than most of them
// run.
#pragma once

#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace server {

/// A statement without values, and not run yet; null where SQLite answers `code`, an error. Two uses of one
/// text at the same time get two statements.
sqlite3_stmt* take_statement(sqlite3* database, std::string_view sql, int& code);

/// For the next use, or away where there are enough of them.
void give_back_statement(sqlite3* database, sqlite3_stmt* statement);

/// Has SQLite ever said of this connection's file that it is damaged? `code`: what a call of it answered.
void note_damage(sqlite3* database, int code);
bool is_damaged(sqlite3* database);

/// Before the connection is closed, which SQLite refuses while it has statements.
void forget_statements(sqlite3* database);

}  // namespace server
