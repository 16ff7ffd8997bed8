// Brings a database file to the schema this build knows.
#pragma once

#include <span>

#include "server/store/database.h"

namespace server {

struct Migration {
  int number = 0;         ///< 1, 2, 3, ...: user_version after it
  std::string_view name;  ///< of its file, server/store/migrations/NNNN_what.sql
  std::string_view sql;
};

/// All migrations of this build, in order; embedded when it was built.
std::span<const Migration> migrations();

/// Applies what is missing, each migration in one transaction. Refused: a file of another application, and a
/// schema newer than the last migration (a downgrade could destroy what it does not know).
api::Status migrate(Database& database, std::span<const Migration> wanted = migrations());

/// migrate() of the database in `file`, after a copy of it as it was is kept beside it: FILE.before-N, N
/// being the number of the newest schema. One such copy is there at a time; a migration that was broken off
/// goes on with the one it made. Errors: also disk_full, where there is no room for the copy.
api::Status migrate_file(Database& database, const std::filesystem::path& file,
                         std::span<const Migration> wanted = migrations());

/// The schema's number, PRAGMA user_version.
api::Result<int> schema_version(Database& database);

/// quick_check and foreign_key_check: is the file whole?
api::Status check_integrity(Database& database);

}  // namespace server
