#include "server/backup_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <set>
#include <system_error>
#include <vector>

#include "api/fault_point.h"
#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/store/maintenance.h"

namespace server {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDatabase = "keylume.db";
constexpr const char* kSums = "SHA256SUMS";
constexpr const char* kPart = ".part";  // ends the name of a folder that is not whole yet
// Written once, by rename: a link to them stays what it is.
const std::set<std::string> kUnchanging{"input", "artefacts", "views", "video", "videos"};

api::Status copy_durably(const fs::path& from, const fs::path& to) {
  FileHandle source(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!source) return file_error(from.string(), errno);
  FileHandle target(::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!target) return file_error(to.string(), errno);
  std::array<char, 64 * 1024> piece;
  for (;;) {
    const ssize_t count = ::read(source.get(), piece.data(), piece.size());
    if (count < 0) return file_error(from.string(), errno);
    if (count == 0) break;
    if (api::Status written = write_all(target, {piece.data(), static_cast<std::size_t>(count)}); !written)
      return written;
  }
  if (::fsync(target.get()) != 0) return file_error(to.string(), errno);
  return api::Done{};
}

api::Status link_or_copy(const fs::path& from, const fs::path& to) {
  if (::link(from.c_str(), to.c_str()) == 0) return api::Done{};
  return copy_durably(from, to);
}

/// All files below `from`; links are left out, as everything that is no regular file.
api::Status take_tree(const fs::path& from, const fs::path& to, bool unchanging) {
  std::error_code error;
  fs::create_directories(to, error);
  if (error) return file_error(to.string(), error.value());
  for (fs::directory_iterator at(from, error), end; !error && at != end; at.increment(error)) {
    const fs::file_status status = at->symlink_status(error);
    const fs::path target = to / at->path().filename();
    api::Status taken = api::Done{};
    if (fs::is_directory(status))
      taken = take_tree(at->path(), target, unchanging);
    else if (fs::is_regular_file(status))
      taken = unchanging ? link_or_copy(at->path(), target) : copy_durably(at->path(), target);
    if (!taken) return taken;
  }
  if (error) return file_error(from.string(), error.value());
  return sync_folder(to);
}

/// not_found: the job's files are gone.
api::Status take_job(const fs::path& from, const fs::path& to, bool succeeded) {
  std::error_code error;
  if (!fs::exists(from / "input", error)) return api::Error{api::Fault::not_found, from.string()};
  fs::create_directories(to, error);
  for (fs::directory_iterator at(from, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    const bool results = name != "input" && kUnchanging.contains(name);
    api::Status taken = api::Done{};
    if (name == "input" || (results && succeeded))
      taken = take_tree(at->path(), to / name, true);
    else if (name == "report.json" || name == "worker.log")
      taken = copy_durably(at->path(), to / name);
    if (!taken) return taken;
  }
  if (error) return file_error(from.string(), error.value());
  return sync_folder(to);
}

api::Status take_jobs(const fs::path& data, const fs::path& to, BackupReport& report) {
  auto database = Database::open(to / kDatabase);
  if (!database) return database.error();
  const auto jobs = kept_jobs(*database);
  if (!jobs) return jobs.error();
  for (const KeptJob& job : *jobs) {
    const api::Status taken = take_job(data / "jobs" / job.id, to / "jobs" / job.id, job.succeeded);
    if (taken) {
      ++report.jobs;
      api::fault_point("backup_job_taken");
      continue;
    }
    std::error_code error;
    // Removed since the database was copied? Then the copy is not to know of it either.
    if (fs::exists(data / "jobs" / job.id / "input", error)) return taken;
    if (api::Status removed = remove_tree(to / "jobs" / job.id); !removed) return removed;
    if (api::Status forgotten = forget_job(*database, job.id); !forgotten) return forgotten;
  }
  // One file again, for the sums.
  return database->execute("PRAGMA wal_checkpoint(TRUNCATE); PRAGMA journal_mode=DELETE");
}

api::Status write_sums(const fs::path& folder, BackupReport& report) {
  std::string sums;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (!at->is_regular_file(error)) continue;
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
  if (::fsync(handle.get()) != 0) return file_error((folder / kSums).string(), errno);
  return sync_folder(folder);
}

/// `make` fills a new folder beside `to`, which then gets its name.
template <class Make>
api::Result<BackupReport> appear_whole(const fs::path& to, const Make& make) {
  std::error_code error;
  if (fs::exists(to, error)) return api::Error{api::Fault::wrong_state, to.string() + " exists already"};
  const fs::path absolute = fs::absolute(to, error).lexically_normal();
  const fs::path part = absolute.string() + kPart;
  if (api::Status removed = remove_tree(part); !removed) return removed.error();
  fs::create_directories(part.parent_path(), error);
  if (::mkdir(part.c_str(), 0700) != 0) return file_error(part.string(), errno);
  BackupReport report;
  api::Status made = make(part, report);
  api::fault_point("folder_made");
  if (made && ::rename(part.c_str(), absolute.c_str()) != 0) made = file_error(absolute.string(), errno);
  api::fault_point("folder_named");
  if (made) made = sync_folder(absolute.parent_path());
  if (made) return report;
  (void)remove_tree(part);
  return made.error();
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

}  // namespace

api::Result<BackupReport> back_up(const fs::path& data, const fs::path& to) {
  std::error_code error;
  if (!fs::exists(data / kDatabase, error))
    return api::Error{api::Fault::not_found,
                      data.string() + " is no data folder: " + kDatabase + " is missing"};
  return appear_whole(to, [&](const fs::path& part, BackupReport& report) -> api::Status {
    if (api::Status copied = copy_database(data / kDatabase, part / kDatabase); !copied) return copied;
    api::fault_point("backup_database_copied");
    if (api::Status taken = take_jobs(data, part, report); !taken) return taken;
    if (fs::exists(data / "tokens", error))
      if (api::Status taken = take_tree(data / "tokens", part / "tokens", false); !taken) return taken;
    return write_sums(part, report);
  });
}

api::Result<BackupReport> restore(const fs::path& backup, const fs::path& data) {
  if (const api::Status whole = refuse_half(backup); !whole) return whole.error();
  const auto sums = read_sums(backup);
  if (!sums) return sums.error();
  for (const Sum& sum : *sums)
    if (const api::Status same = check_sum(backup, sum); !same) return same.error();
  return appear_whole(data, [&](const fs::path& part, BackupReport& report) -> api::Status {
    for (const Sum& sum : *sums) {
      std::error_code error;
      fs::create_directories((part / sum.path).parent_path(), error);
      if (api::Status copied = copy_durably(backup / sum.path, part / sum.path); !copied) return copied;
      ++report.files;
      report.bytes += static_cast<std::int64_t>(fs::file_size(part / sum.path, error));
      api::fault_point("restore_file_copied");
    }
    return sync_folder(part);
  });
}

}  // namespace server
