#include "server/backup_folder.h"

#include <fcntl.h>

#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

#include "api/fault_point.h"
#include "api/given_names.h"
#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/copy_tree.h"
#include "server/store/job_store.h"
#include "server/store/maintenance.h"

namespace server {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDatabase = "keylume.db";
constexpr const char* kSums = "SHA256SUMS";
constexpr const char* kJobs = "jobs";
constexpr const char* kSumsEnd = ".sha256";

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// A view gets its name when it is whole, a video has its sum from then on. Requests for views are taken
/// too: they are fulfilled where the copy is served.
api::Status take_made_later(const fs::path& from, const fs::path& to) {
  const auto no_report = [](const std::string& name) { return !name.ends_with(".report.json"); };
  if (api::Status taken = take_some(from / "views", to / "views", Taking::links, no_report); !taken)
    return taken;
  const auto whole = [&](const std::string& name) {
    return name.ends_with(kSumsEnd) || is_there(from / "videos" / (name + kSumsEnd));
  };
  if (api::Status taken = take_some(from / "videos", to / "videos", Taking::links, whole); !taken)
    return taken;
  // One that is removed, or made anew, in the meantime is not taken by half.
  std::error_code error;
  for (fs::directory_iterator at(to / "views", error), end; !error && at != end; at.increment(error))
    if (at->is_directory(error) && !is_there(from / "views" / at->path().filename()))
      if (api::Status removed = remove_tree(at->path()); !removed) return removed;
  return api::Done{};
}

/// What a worker is at, or will be, is copied: whatever it writes there later must not reach the copy.
api::Status take_job(const fs::path& from, const fs::path& to, bool succeeded) {
  if (api::Status taken = take_tree(from / "input", to / "input", succeeded ? Taking::links : Taking::copies);
      !taken)
    return taken;
  const auto told = [](const std::string& name) {
    return name == "report.json" || name == "worker.log" || name == api::kGivenNamesFile;
  };
  if (api::Status taken = take_some(from, to, Taking::copies, told); !taken || !succeeded) return taken;
  if (api::Status taken = take_tree(from / "artefacts", to / "artefacts", Taking::links); !taken)
    return taken;
  return take_made_later(from, to);
}

/// The copy is not to know of a job that was removed since the database was copied.
api::Status leave_out(Database& copy, const fs::path& folder, const std::string& id) {
  if (api::Status removed = remove_tree(folder / kJobs / id); !removed) return removed;
  return forget_job(copy, id);
}

/// One file again, for the sums.
api::Status into_one_file(Database& database) {
  return database.execute("PRAGMA wal_checkpoint(TRUNCATE); PRAGMA journal_mode=DELETE");
}

api::Status take_jobs(const fs::path& data, const fs::path& to, BackupReport& report) {
  auto original = Database::open_to_read(data / kDatabase);
  if (!original) return original.error();
  auto copy = Database::open(to / kDatabase);
  if (!copy) return copy.error();
  if (api::Status ended = end_attempts_of_copy(*copy, system_clock_ms()); !ended) return ended;
  const auto jobs = kept_jobs(*copy);
  if (!jobs) return jobs.error();
  for (const KeptJob& job : *jobs) {
    if (api::Status taken = take_job(data / kJobs / job.id, to / kJobs / job.id, job.succeeded); !taken)
      return taken;
    const auto kept = is_kept(*original, job.id);
    if (!kept) return kept.error();
    if (!*kept) {
      if (api::Status left = leave_out(*copy, to, job.id); !left) return left;
      continue;
    }
    if (!is_there(data / kJobs / job.id / "input"))
      return api::Error{api::Fault::internal, job.id + ": its folder input is gone; see check"};
    ++report.jobs;
    api::fault_point("backup_job_taken");
  }
  return into_one_file(*copy);
}

api::Status write_sums(const fs::path& folder, BackupReport& report) {
  std::string sums;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (!at->is_regular_file(error) || at->path().filename() == kHalfMade) continue;
    const fs::path relative = at->path().lexically_relative(folder);
    const auto file = open_below(folder, relative.string());
    if (!file) return file.error();
    const auto hash = sha256_of(*file);
    if (!hash) return hash.error();
    sums += *hash + "  " + relative.string() + "\n";
    ++report.files;
    report.bytes += static_cast<std::int64_t>(at->file_size(error));
  }
  if (error) return file_error(folder.string(), error.value());
  FileHandle handle(::open((folder / kSums).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!handle) return file_error((folder / kSums).string(), errno);
  if (api::Status written = write_all(handle, sums); !written) return written;
  api::fault_point("backup_sums_written");
  return api::Done{};
}

struct Sum {
  std::string sha256;
  std::string path;
};

/// Says it where `backup` is what a backup that did not come to its end has left.
api::Status refuse_half(const fs::path& backup) {
  const auto half = [](const std::string& name) {
    return api::Error{api::Fault::invalid_request,
                      name + " is half a backup, left by one that did not come to its end; make it anew"};
  };
  std::error_code error;
  const std::string name = backup.lexically_normal().string();
  if (name.ends_with(kPart) || name.ends_with(std::string(kPart) + "/")) return half(name);
  if (!fs::exists(backup, error) && fs::exists(name + kPart, error)) return half(name + kPart);
  if (!fs::exists(backup, error)) return api::Error{api::Fault::not_found, name + " does not exist"};
  return api::Done{};
}

api::Result<std::vector<Sum>> read_sums(const fs::path& backup) {
  std::ifstream file(backup / kSums);
  std::vector<Sum> sums;
  for (std::string line; std::getline(file, line);) {
    if (line.size() < 67 || line.compare(64, 2, "  ") != 0 || !is_plain_relative_path(line.substr(66)))
      return api::Error{api::Fault::invalid_request, "SHA256SUMS has a line that is none: " + line};
    sums.push_back({line.substr(0, 64), line.substr(66)});
  }
  if (sums.empty())
    return api::Error{api::Fault::invalid_request, backup.string() + " is no backup: SHA256SUMS is missing"};
  return sums;
}

api::Status check_sum(const fs::path& backup, const Sum& sum) {
  const auto file = open_below(backup, sum.path);
  if (!file) return api::Error{api::Fault::invalid_request, sum.path + " is missing"};
  const auto hash = sha256_of(*file);
  if (!hash) return hash.error();
  if (*hash != sum.sha256)
    return api::Error{api::Fault::invalid_request, sum.path + " is not as SHA256SUMS says"};
  return api::Done{};
}

/// The job that a file of a backup belongs to; none: all of them need it.
std::string job_of(const std::string& path) {
  const std::string folder = std::string(kJobs) + "/";
  if (!path.starts_with(folder)) return {};
  return path.substr(folder.size(), path.find('/', folder.size()) - folder.size());
}

/// Finds the jobs with a file that is not as it was. Errors: a file that all jobs need.
api::Status find_damage(const fs::path& backup, const std::vector<Sum>& sums, BackupReport& report) {
  for (const Sum& sum : sums) {
    const api::Status same = check_sum(backup, sum);
    if (same) continue;
    const std::string job = job_of(sum.path);
    if (job.empty()) return same;
    report.left_out.emplace(job, same.error().message);
  }
  return api::Done{};
}

/// Backups of earlier versions still know whose workers they were.
api::Status settle_copy(const fs::path& folder, const BackupReport& report) {
  auto copy = Database::open(folder / kDatabase);
  if (!copy) return copy.error();
  if (api::Status ended = end_attempts_of_copy(*copy, system_clock_ms()); !ended) return ended;
  for (const auto& [job, why] : report.left_out)
    if (api::Status forgotten = forget_job(*copy, job); !forgotten) return forgotten;
  return into_one_file(*copy);
}

api::Status copy_back(const fs::path& backup, const std::vector<Sum>& sums, const fs::path& part,
                      BackupReport& report) {
  for (const Sum& sum : sums) {
    if (report.left_out.contains(job_of(sum.path))) continue;
    std::error_code error;
    fs::create_directories((part / sum.path).parent_path(), error);
    if (api::Status copied = copy_durably(backup / sum.path, part / sum.path); !copied) return copied;
    ++report.files;
    report.bytes += static_cast<std::int64_t>(fs::file_size(part / sum.path, error));
    api::fault_point("restore_file_copied");
  }
  return settle_copy(part, report);
}

}  // namespace

api::Result<BackupReport> back_up(const fs::path& data, const fs::path& to) {
  if (!is_there(data / kDatabase))
    return api::Error{api::Fault::not_found,
                      data.string() + " is no data folder: " + kDatabase + " is missing"};
  BackupReport report;
  const api::Status made = appear_whole(to, [&](const fs::path& part) -> api::Status {
    if (api::Status copied = copy_database(data / kDatabase, part / kDatabase); !copied) return copied;
    api::fault_point("backup_database_copied");
    if (api::Status taken = take_jobs(data, part, report); !taken) return taken;
    if (api::Status taken = take_tree(data / "tokens", part / "tokens", Taking::copies); !taken) return taken;
    return write_sums(part, report);
  });
  if (!made) return made.error();
  return report;
}

api::Result<BackupReport> restore(const fs::path& backup, const fs::path& data) {
  if (const api::Status whole = refuse_half(backup); !whole) return whole.error();
  const auto sums = read_sums(backup);
  if (!sums) return sums.error();
  BackupReport report;
  if (api::Status usable = find_damage(backup, *sums, report); !usable) return usable.error();
  const api::Status made =
      appear_whole(data, [&](const fs::path& part) { return copy_back(backup, *sums, part, report); });
  if (!made) return made.error();
  return report;
}

}  // namespace server
