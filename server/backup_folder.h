// A backup: a folder with the database, the tokens, the files of every job, and SHA256SUMS over all of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "api/result.h"

namespace server {

struct BackupReport {
  std::int64_t jobs = 0;
  std::int64_t files = 0;
  std::int64_t bytes = 0;
  /// By `restore`: jobs with a file that is not as it was, and what is wrong with it. They stay in the
  /// backup.
  std::map<std::string, std::string> left_out = {};
};

/// Also while a server runs on `data`. Files that never change are linked where the file system allows, else
/// copied; `to` appears by rename, whole or not at all. What a running job has not published is left out: it
/// begins anew in the copy, which knows nothing of the workers here. Errors: wrong_state where `to` exists,
/// disk_full, internal.
api::Result<BackupReport> back_up(const std::filesystem::path& data, const std::filesystem::path& to);

/// Copies the backup into a data folder that does not exist yet, after every file has been found as
/// SHA256SUMS says. A job with one that differs is left out, the others are restored. Errors: invalid_request
/// naming a file that differs and that all jobs need, wrong_state, disk_full, internal.
api::Result<BackupReport> restore(const std::filesystem::path& backup, const std::filesystem::path& data);

}  // namespace server
