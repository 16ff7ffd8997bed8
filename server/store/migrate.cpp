#include "server/store/migrate.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "api/fault_point.h"
#include "server/store/maintenance.h"

namespace server {
namespace {

constexpr std::int64_t kApplicationId = 0x4b4c4d31;  // "KLM1": tells our files from other SQLite files

api::Result<std::int64_t> pragma_value(Database& database, std::string_view name) {
  Statement read = database.prepare("PRAGMA " + std::string(name));
  const std::int64_t value = read.next() ? read.integer(0) : 0;
  if (const api::Status ok = read.status(); !ok) return ok.error();
  return value;
}

api::Status check_references(Database& database) {
  Statement keys = database.prepare("PRAGMA foreign_key_check");
  if (keys.next())
    return api::Error{api::Fault::internal,
                      "database is damaged: a row of " + keys.text(0) + " refers to a row that is gone"};
  return keys.status();
}

api::Status apply(Database& database, const Migration& migration) {
  Transaction transaction(database);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  const std::string version = "PRAGMA user_version=" + std::to_string(migration.number);
  for (const std::string& script : {std::string(migration.sql), version}) {
    const api::Status done = database.execute(script);
    if (!done)
      return api::Error{done.error().fault,
                        "migration " + std::string(migration.name) + ": " + done.error().message};
  }
  if (api::Status whole = check_references(database); !whole) return whole;
  api::fault_point("migration_begun");
  api::Status committed = transaction.commit();
  api::fault_point("migrated");
  return committed;
}

// A table is replaced by dropping it, and with foreign keys on that would delete what refers to its rows. The
// pragma does nothing within a transaction.
api::Status apply_all(Database& database, std::span<const Migration> missing) {
  if (missing.empty()) return api::Done{};
  if (api::Status off = database.execute("PRAGMA foreign_keys=OFF"); !off) return off;
  api::Status applied = api::Done{};
  for (const Migration& migration : missing)
    if (applied) applied = apply(database, migration);
  if (api::Status on = database.execute("PRAGMA foreign_keys=ON"); !on) return on;
  const auto enforced = pragma_value(database, "foreign_keys");
  if (applied && (!enforced || *enforced != 1))
    return api::Error{api::Fault::internal, "database: foreign keys do not come on again"};
  return applied;
}

api::Status claim_file(Database& database, int version) {
  const auto id = pragma_value(database, "application_id");
  if (!id) return id.error();
  if (*id == kApplicationId) return api::Done{};
  Statement tables = database.prepare("SELECT count(*) FROM sqlite_schema");
  const bool empty = tables.next() && tables.integer(0) == 0;
  if (api::Status ok = tables.status(); !ok) return ok;
  if (*id != 0 || version != 0 || !empty)
    return api::Error{api::Fault::internal, "database: the file belongs to another application"};
  return database.execute("PRAGMA application_id=" + std::to_string(kApplicationId));
}

/// Other copies of this kind; all of those that are not whole.
void remove_copies(const std::filesystem::path& file, const std::filesystem::path& but) {
  const std::string begin = file.filename().string() + ".before-";
  std::error_code error;
  std::vector<std::filesystem::path> found;
  for (std::filesystem::directory_iterator at(file.parent_path(), error), end; !error && at != end;
       at.increment(error))
    if (at->path().filename().string().starts_with(begin) && at->path() != but) found.push_back(at->path());
  for (const auto& path : found) std::filesystem::remove(path, error);
}

api::Status keep_copy(const std::filesystem::path& file, const std::filesystem::path& kept) {
  std::error_code error;
  if (std::filesystem::exists(kept, error)) return api::Done{};
  const std::filesystem::path part = kept.string() + ".part";
  std::filesystem::remove(part, error);
  api::Status copied = copy_database(file, part);
  if (!copied)
    copied =
        api::Error{copied.error().fault, "the copy of the database before it is brought to a new schema: " +
                                             copied.error().message};
  if (copied) {
    std::filesystem::rename(part, kept, error);
    if (error) copied = api::Error{api::Fault::internal, kept.string() + ": " + error.message()};
  }
  if (!copied) std::filesystem::remove(part, error);
  return copied;
}

}  // namespace

api::Result<int> schema_version(Database& database) {
  const auto version = pragma_value(database, "user_version");
  if (!version) return version.error();
  return static_cast<int>(*version);
}

api::Status migrate(Database& database, std::span<const Migration> wanted) {
  const auto version = schema_version(database);
  if (!version) return version.error();
  const int newest = wanted.empty() ? 0 : wanted.back().number;
  if (*version > newest)
    return api::Error{api::Fault::internal, "database: its schema is version " + std::to_string(*version) +
                                                ", this build knows up to " + std::to_string(newest) +
                                                "; start a newer keylume-server"};
  if (api::Status ours = claim_file(database, *version); !ours) return ours;
  const auto first = std::find_if(wanted.begin(), wanted.end(),
                                  [&](const Migration& migration) { return migration.number > *version; });
  return apply_all(database, {first, wanted.end()});
}

api::Status migrate_file(Database& database, const std::filesystem::path& file,
                         std::span<const Migration> wanted) {
  const auto version = schema_version(database);
  if (!version) return version.error();
  const int newest = wanted.empty() ? 0 : wanted.back().number;
  // A new one has nothing to lose; one of a newer version is refused below.
  if (*version == 0 || *version >= newest) return migrate(database, wanted);
  const std::filesystem::path kept = file.string() + ".before-" + std::to_string(newest);
  if (api::Status copied = keep_copy(file, kept); !copied) return copied;
  if (api::Status migrated = migrate(database, wanted); !migrated) return migrated;
  remove_copies(file, kept);
  return api::Done{};
}

api::Status check_integrity(Database& database) {
  Statement quick = database.prepare("PRAGMA quick_check(1)");
  const std::string answer = quick.next() ? quick.text(0) : "no answer";
  if (api::Status ok = quick.status(); !ok) return ok;
  if (answer != "ok") return api::Error{api::Fault::internal, "database is damaged: " + answer};
  return check_references(database);
}

}  // namespace server
