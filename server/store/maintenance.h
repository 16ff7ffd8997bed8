// Looking after a database: copies of it, and whether it is whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "server/store/database.h"

namespace server {

/// A copy of the database as it is at one moment, by SQLite's online backup, while others write to it
/// as much as they like. `to`
/// must not exist; it is one file, without -wal and -shm, and durable. Errors: disk_full, internal.
api::Status copy_database(const std::filesystem::path& from, const std::filesystem::path& to);

/// integrity_check and foreign_key_check in full: a sentence for each thing that is wrong, at most 100.
api::Result<std::vector<std::string>> damage_of(Database& database);

/// A job's file, as the database knows it.
struct KeptFile {
  std::int64_t job_seq = 0;
  std::string job_id;
  std::string path;  ///< relative to the job's folder artefacts/ or input/
  std::int64_t bytes = 0;
  std::string sha256;
  bool is_input = false;

  const char* folder() const { return is_input ? "input" : "artefacts"; }
};
/// Artefacts, and inputs as far as their hashes are known.
api::Result<std::vector<KeptFile>> kept_files(Database& database);
/// At most `limit` artefacts, or inputs, by job and path, beginning after (`after_seq`, `after_path`).
api::Result<std::vector<KeptFile>> kept_files_after(Database& database, bool inputs, std::int64_t after_seq,
                                                    std::string_view after_path, std::int64_t limit);

/// The blobs that somebody has, by their hashes; none in a database of before they had owners.
api::Result<std::vector<std::string>> kept_blobs(Database& database);

struct KeptJob {
  std::string id;
  bool succeeded = false;
};
/// Those being removed are left out.
api::Result<std::vector<KeptJob>> kept_jobs(Database& database);
/// Is there still such a job, and not about to go?
api::Result<bool> is_kept(Database& database, const std::string& id);

/// What was submitted with a job, as the database knows it: below its folder input/.
struct KeptInput {
  std::string job_id;
  std::string name;
  std::int64_t bytes = 0;
};
api::Result<std::vector<KeptInput>> kept_inputs(Database& database);

/// Of a copy: what was under way begins anew, with the reason "restored". The workers belong to the original:
/// a server that starts on the copy must not take them for its own and end them.
api::Status end_attempts_of_copy(Database& database, std::int64_t now_ms);
/// Of a copy: the job was removed while its files were copied.
api::Status forget_job(Database& database, const std::string& id);

}  // namespace server
