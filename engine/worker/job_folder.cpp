#include "engine/worker/job_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "engine/base/durable_file.h"
#include "engine/output/artefacts.h"
#include "engine/worker/outcome.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

/// A file descriptor that closes itself.
class File {
 public:
  explicit File(int file) : file_(file) {}
  File(const File&) = delete;
  ~File() {
    if (file_ >= 0) close(file_);
  }
  int get() const { return file_; }

 private:
  int file_;
};

/// As DurableFile names a file while it is being written.
bool is_temporary(const fs::path& path) {
  return path.filename().string().starts_with(".tmp.");
}

void remove_temporary_files(const fs::path& artefacts) {
  std::vector<fs::path> leftovers;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(artefacts))
    if (is_temporary(entry.path()) && !fs::is_directory(entry.symlink_status()))
      leftovers.push_back(entry.path());
  for (const fs::path& path : leftovers) fs::remove(path);
}

api::ReadRequest refused_input(std::string code, std::string detail) {
  return {.request = {},
          .is_document = false,
          .violations = {{"animation.json", "", 0, 0, std::move(code), std::move(detail)}}};
}

/// All of a file of known size; what was appended meanwhile is not read.
std::optional<std::string> read_bytes(int file, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t have = 0;
  while (have < size) {
    const ssize_t got = read(file, bytes.data() + have, size - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return std::nullopt;
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  bytes.resize(have);
  return bytes;
}

/// Over what is there. `durable`: waits for the disk.
api::Status overwrite(const fs::path& path, std::string_view bytes, bool durable) {
  const File file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640));
  if (file.get() < 0) return file_error("open", path, errno);
  while (!bytes.empty()) {
    const ssize_t written = write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return file_error("write", path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (durable && fsync(file.get()) != 0) return file_error("fsync", path, errno);
  return api::Done{};
}

void remove_report(const fs::path& path, ReportWriting writing) {
  if (writing == ReportWriting::replaced)
    fs::remove(path);
  else if (const api::Status emptied = overwrite(path, "", false); !emptied)
    throw std::runtime_error(emptied.error().message);
}

/// Made where it is missing, so that it can be written to in a folder where nothing can be made. What is
/// there under another name too, an input say, or is another kind of thing, goes: writing would change more
/// than it.
void make_file_of_its_own(const fs::path& path) {
  struct stat about {};
  if (::lstat(path.c_str(), &about) == 0 && !S_ISDIR(about.st_mode) &&
      (!S_ISREG(about.st_mode) || about.st_nlink != 1))
    (void)::unlink(path.c_str());
  const File made(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0640));
}

/// `folders` and `files` of the job's folder are written, which is read. What cannot be made is passed over,
/// and missed when it is needed.
FileRules rules_in(const fs::path& job_folder, std::initializer_list<const char*> folders,
                   std::initializer_list<const char*> files) {
  FileRules rules;
  rules.read = {job_folder};
  for (const char* name : folders) {
    std::error_code ignored;
    if (fs::is_symlink(fs::symlink_status(job_folder / name, ignored)))
      fs::remove(job_folder / name, ignored);
    fs::create_directory(job_folder / name, ignored);
    rules.write.push_back(job_folder / name);
  }
  for (const char* name : files) {
    make_file_of_its_own(job_folder / name);
    rules.write.push_back(job_folder / name);
  }
  return rules;
}

}  // namespace

FileRules rules_of_run(const fs::path& job_folder) {
  return rules_in(job_folder, {"artefacts", "checkpoint"}, {".lock", "progress.ndjson", "report.json"});
}

FileRules rules_of_check(const fs::path& job_folder, bool with_preview) {
  if (with_preview) return rules_in(job_folder, {"preview"}, {"check.json"});
  return rules_in(job_folder, {}, {"check.json"});
}

api::Result<JobFolder> JobFolder::open(const fs::path& path, std::chrono::milliseconds patience) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored))
    return api::Error{api::Fault::not_found, path.string() + " is not a folder"};
  const fs::path lock_path = path / ".lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (lock < 0) return file_error("open", lock_path, errno);
  JobFolder folder(path, lock);
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (flock(lock, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return file_error("lock", lock_path, errno);
    if (std::chrono::steady_clock::now() >= give_up)
      return api::Error{api::Fault::wrong_state, "another worker is at " + path.string()};
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return folder;
}

api::Result<JobFolder> JobFolder::look_into(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored))
    return api::Error{api::Fault::not_found, path.string() + " is not a folder"};
  return JobFolder(path, -1);
}

JobFolder::JobFolder(JobFolder&& other) noexcept : path_(std::move(other.path_)), lock_(other.lock_) {
  other.lock_ = -1;
}

JobFolder::~JobFolder() {
  if (lock_ >= 0) close(lock_);
}

api::Status clear_leftovers(const JobFolder& folder, ReportWriting writing) {
  return without_exceptions([&]() -> api::Status {
    if (fs::create_directories(folder.artefacts())) {
      if (const api::Status synced = sync_folder(folder.artefacts().parent_path()); !synced) return synced;
    }
    if (fs::remove(folder.artefacts() / "manifest.json")) {
      if (const api::Status synced = sync_folder(folder.artefacts()); !synced) return synced;
    }
    remove_report(folder.report(), writing);
    remove_temporary_files(folder.artefacts());
    return api::Done{};
  });
}

api::Result<api::ReadRequest> read_job_request(const JobFolder& folder) {
  const fs::path path = folder.input() / "animation.json";
  // O_NONBLOCK: a pipe in its place must not hang us; it has no effect on files.
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0 && errno == ENOENT)
    return refused_input("missing_file", "there is no such file in the job's input folder");
  struct stat about {};
  if (file.get() < 0 || fstat(file.get(), &about) != 0) return file_error("read", path, errno);
  if (!S_ISREG(about.st_mode)) return refused_input("not_a_file", "this is not a regular file");
  const auto size = static_cast<std::uint64_t>(about.st_size);
  if (size > api::kAnimationBytesMax)
    return refused_input("too_large", std::to_string(size) + " bytes; at most " +
                                          std::to_string(api::kAnimationBytesMax) + " are allowed");
  const auto bytes = read_bytes(file.get(), size);
  if (!bytes) return file_error("read", path, errno);
  return api::read_request(*bytes);
}

api::Status write_report(const fs::path& path, const api::JobReport& report, ReportWriting writing) {
  return without_exceptions([&] {
    const std::string bytes = api::job_report_json(report);
    return writing == ReportWriting::replaced ? write_file(path, bytes) : overwrite(path, bytes, true);
  });
}

void write_report_in_haste(const fs::path& path, const api::JobReport& report, ReportWriting writing) {
  if (writing == ReportWriting::in_place) {
    (void)overwrite(path, api::job_report_json(report), false);
    return;
  }
  const fs::path temporary = path.parent_path() / (".tmp.last_words." + path.filename().string());
  const std::string bytes = api::job_report_json(report);
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (file < 0) return;
  const bool whole = write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  close(file);
  if (whole)
    rename(temporary.c_str(), path.c_str());
  else
    unlink(temporary.c_str());
}

}  // namespace engine
