// keylume-server backup|restore|check|gc|migrate
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <set>
#include <utility>

#include "api/fault_point.h"
#include "server/artefacts/blobs.h"
#include "server/artefacts/data_folder.h"
#include "server/artefacts/verify.h"
#include "server/backup_folder.h"
#include "server/commands.h"
#include "server/jobs/collect_results.h"
#include "server/jobs/job_service.h"
#include "server/store/maintenance.h"
#include "server/store/migrate.h"

namespace server {
namespace {

namespace fs = std::filesystem;

/// Removed while it was looked at, it is nothing to complain of.
bool still_there(Database& database, const std::string& job_id) {
  const auto kept = is_kept(database, job_id);
  return !kept || *kept;
}

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
  for (const auto& [job, why] : report->left_out)
    std::cerr << "keylume-server: left out " << job << ": " << why << "\n";
  return report->left_out.empty() ? 0 : kExitFailed;
}

using Sentences = std::vector<std::string>;

/// What is wrong with the files, a sentence each.
Sentences wrong_files(const fs::path& data, Database& database, const std::vector<KeptFile>& files) {
  Sentences wrong;
  for (const KeptFile& file : files) {
    // Each for itself: a backup beside the data folder has given them second names.
    const api::Status same =
        verify_file(data / "jobs" / file.job_id / file.folder(),
                    {file.path, file.bytes, file.sha256, file.is_input ? "input" : "artefact"});
    if (!same && still_there(database, file.job_id))
      wrong.push_back(file.job_id + ": " + same.error().message);
  }
  return wrong;
}

/// Of what was submitted to earlier versions the size alone is kept.
Sentences wrong_inputs(const fs::path& data, Database& database, const std::vector<KeptInput>& inputs,
                       const std::vector<KeptFile>& with_hash) {
  Sentences wrong;
  std::set<std::pair<std::string_view, std::string_view>> looked_at;
  for (const KeptFile& file : with_hash)
    if (file.is_input) looked_at.emplace(file.job_id, file.path);
  for (const KeptInput& input : inputs) {
    if (looked_at.contains({input.job_id, input.name})) continue;
    const auto file = open_below(data / "jobs" / input.job_id / "input", input.name);
    const auto bytes = file ? size_of(*file) : api::Result<std::int64_t>(file.error());
    if (bytes && *bytes == input.bytes) continue;
    if (still_there(database, input.job_id))
      wrong.push_back(input.job_id + ": input/" + input.name +
                      (bytes ? " is not as long as it was" : " is missing"));
  }
  return wrong;
}

/// A view says itself what is in it, a video has its sum beside it.
Sentences wrong_made_later(const fs::path& job, std::size_t& checked) {
  Sentences wrong;
  std::error_code error;
  for (fs::directory_iterator at(job / "views", error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(".tmp.") || !at->is_directory(error)) continue;
    ++checked;
    const auto files = check_files(at->path());
    if (!files && fs::exists(at->path(), error))
      wrong.push_back("views/" + name + ": " + files.error().message);
  }
  error.clear();
  for (fs::directory_iterator at(job / "videos", error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string(), sum = name + ".sha256";
    const auto expected = read_below(job / "videos", sum, 64);
    if (!expected) continue;
    ++checked;
    const auto file = open_below(job / "videos", name);
    const auto found = file ? sha256_of(*file) : api::Result<std::string>(file.error());
    if ((!found || *found != *expected) && fs::exists(at->path(), error))
      wrong.push_back("videos/" + name + " is not as it was made");
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

/// All files that the database knows of.
api::Result<Sentences> wrong_below(const fs::path& data, Database& database, std::size_t& checked) {
  const auto files = kept_files(database);
  if (!files) return files.error();
  const auto inputs = kept_inputs(database);
  if (!inputs) return inputs.error();
  const auto jobs = kept_jobs(database);
  if (!jobs) return jobs.error();
  const auto blobs = kept_blobs(database);
  if (!blobs) return blobs.error();
  checked = inputs->size() + blobs->size();
  for (const KeptFile& file : *files) checked += file.is_input ? 0 : 1;
  api::fault_point("check_listed");
  Sentences wrong = wrong_files(data, database, *files);
  const auto add = [&wrong](Sentences more) {
    wrong.insert(wrong.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  add(wrong_inputs(data, database, *inputs, *files));
  for (const KeptJob& job : *jobs) {
    const Sentences made = wrong_made_later(data / "jobs" / job.id, checked);
    for (const std::string& sentence : made)
      if (still_there(database, job.id)) wrong.push_back(job.id + ": " + sentence);
  }
  add(wrong_blobs(data, *blobs));
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
    auto found = wrong_below(data, *database, checked);
    if (!found) return refuse_command(found.error(), kExitFailed);
    *wrong = std::move(*found);
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
