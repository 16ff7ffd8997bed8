// keylume-server backup|restore|check|gc|migrate
#include <cstdio>
#include <iostream>

#include "server/artefacts/blobs.h"
#include "server/artefacts/data_folder.h"
#include "server/artefacts/verify.h"
#include "server/backup_folder.h"
#include "server/commands.h"
#include "server/jobs/job_service.h"
#include "server/store/maintenance.h"
#include "server/store/migrate.h"

namespace server {
namespace {

int exit_code_of(const api::Error& error) {
  return error.fault == api::Fault::wrong_state ? kExitInUse : kExitFailed;
}

api::Error one_path_needed(std::string_view command, std::string_view what) {
  return {api::Fault::invalid_request,
          std::string(command) + ": " + std::string(what) + " is needed, and one only"};
}

int say(const api::Result<BackupReport>& report, std::string_view what) {
  if (!report) return refuse_command(report.error(), exit_code_of(report.error()));
  std::cout << what << ": " << report->files << " files, " << report->bytes << " bytes\n";
  return 0;
}

/// What is wrong with the files, a sentence each.
std::vector<std::string> wrong_files(const std::filesystem::path& data, const std::vector<KeptFile>& files) {
  std::vector<std::string> wrong;
  for (const KeptFile& file : files) {
    // Each for itself: a backup beside the data folder has given them second names.
    const api::Status same =
        verify_file(data / "jobs" / file.job_id / "artefacts", {file.path, file.bytes, file.sha256});
    if (!same) wrong.push_back(file.job_id + ": " + same.error().message);
  }
  return wrong;
}

/// Blobs whose bytes are not what their name says. A missing one is sent again by whoever needs it.
std::vector<std::string> wrong_blobs(const std::filesystem::path& data,
                                     const std::vector<std::string>& hashes) {
  std::vector<std::string> wrong;
  for (const std::string& sha256 : hashes) {
    const auto checked = check_blob(data / "blobs" / sha256.substr(0, 2) / sha256, sha256);
    if (!checked && checked.error().fault != api::Fault::not_found)
      wrong.push_back("blob " + sha256 + ": " + checked.error().message);
  }
  return wrong;
}

}  // namespace

int run_backup_command(std::span<const std::string_view> given) {
  const auto words = take_apart(given, {}, {});
  if (!words) return refuse_command(words.error(), kExitUsage);
  if (words->plain.size() != 1)
    return refuse_command(one_path_needed("backup", "a folder to make"), kExitUsage);
  return say(back_up(*words->option("--data"), words->plain[0]), "backed up");
}

int run_restore_command(std::span<const std::string_view> given) {
  const auto words = take_apart(given, {}, {});
  if (!words) return refuse_command(words.error(), kExitUsage);
  if (words->plain.size() != 1) return refuse_command(one_path_needed("restore", "a backup"), kExitUsage);
  return say(restore(words->plain[0], *words->option("--data")), "restored");
}

int run_check_command(std::span<const std::string_view> given) {
  const auto words = take_apart(given, {}, {});
  if (!words) return refuse_command(words.error(), kExitUsage);
  const std::filesystem::path data = *words->option("--data");
  auto database = Database::open_to_read(data / "keylume.db");
  if (!database) return refuse_command(database.error(), kExitFailed);
  auto wrong = damage_of(*database);
  if (!wrong) return refuse_command(wrong.error(), kExitFailed);
  std::size_t checked = 0;
  // A damaged database says nothing about files that can be relied on.
  if (wrong->empty()) {
    const auto files = kept_files(*database);
    if (!files) return refuse_command(files.error(), kExitFailed);
    checked = files->size();
    *wrong = wrong_files(data, *files);
    const auto blobs = kept_blobs(*database);
    if (!blobs) return refuse_command(blobs.error(), kExitFailed);
    checked += blobs->size();
    for (std::string& sentence : wrong_blobs(data, *blobs)) wrong->push_back(std::move(sentence));
  }
  for (const std::string& sentence : *wrong) std::cout << sentence << "\n";
  std::cout << (wrong->empty() ? "whole" : "damaged") << ": database and " << checked << " files looked at\n";
  return wrong->empty() ? 0 : kExitFailed;
}

int run_gc_command(std::span<const std::string_view> given) {
  const auto words = take_apart(given, {}, {});
  if (!words) return refuse_command(words.error(), kExitUsage);
  const auto folder = DataFolder::open(*words->option("--data"));
  if (!folder) return refuse_command(folder.error(), exit_code_of(folder.error()));
  const auto store = JobStore::open(folder->database());
  if (!store) return refuse_command(store.error(), kExitFailed);
  JobService jobs(**store, *folder, {});
  if (const api::Status clean = jobs.clean_up(); !clean) return refuse_command(clean.error(), kExitFailed);
  if (const api::Status done = jobs.collect_garbage(); !done)
    return refuse_command(done.error(), kExitFailed);
  const GarbageReport report = jobs.garbage();
  std::cout << "removed: " << report.jobs << " jobs, " << report.bytes << " bytes\n";
  return 0;
}

int run_migrate_command(std::span<const std::string_view> given) {
  const auto words = take_apart(given, {}, {});
  if (!words) return refuse_command(words.error(), kExitUsage);
  const auto folder = DataFolder::open(*words->option("--data"));
  if (!folder) return refuse_command(folder.error(), exit_code_of(folder.error()));
  if (const auto store = JobStore::open(folder->database()); !store)
    return refuse_command(store.error(), kExitFailed);
  std::cout << "the database has schema " << migrations().back().number << "\n";
  return 0;
}

}  // namespace server
