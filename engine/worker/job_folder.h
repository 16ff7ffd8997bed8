// JOB_FOLDER and who may work in it: input/, artefacts/, checkpoint/, progress.ndjson, report.json, .lock of
// `render`, check.json and preview/ of `check`.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "api/job_report.h"
#include "api/read_request.h"
#include "api/result.h"
#include "engine/worker/landlock.h"

namespace engine {

/// A job's folder, locked for this process until the object or the process ends, however it ends.
class JobFolder {
 public:
  /// Takes the exclusive lock JOB_FOLDER/.lock. A worker that is just dying still holds it for a moment, so
  /// it is tried for up to `patience`.
  /// Errors: not_found (no such folder), wrong_state (another worker is at it), internal.
  static api::Result<JobFolder> open(const std::filesystem::path& path,
                                     std::chrono::milliseconds patience = std::chrono::seconds(2));

  /// Without the lock, for who leaves alone what a worker at it writes. Error: not_found.
  static api::Result<JobFolder> look_into(const std::filesystem::path& path);

  JobFolder(JobFolder&& other) noexcept;
  JobFolder& operator=(JobFolder&&) = delete;
  ~JobFolder();

  std::filesystem::path input() const { return path_ / "input"; }
  std::filesystem::path artefacts() const { return path_ / "artefacts"; }
  /// What a killed attempt leaves for the next one; see engine/base/checkpoint.h.
  std::filesystem::path checkpoint() const { return path_ / "checkpoint"; }
  std::filesystem::path progress() const { return path_ / "progress.ndjson"; }
  std::filesystem::path report() const { return path_ / "report.json"; }
  /// The report of a check, apart from that of a run, which it must not replace.
  std::filesystem::path check_report() const { return path_ / "check.json"; }
  /// What the scene looks like, where a check was asked for it. In a folder of its own: to make a file needs
  /// the right to make others beside it.
  std::filesystem::path preview() const { return path_ / "preview" / "preview.npz"; }

 private:
  JobFolder(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::filesystem::path path_;
  int lock_;  ///< file descriptor that carries the lock; -1: none
};

/// What a run in this folder may touch: it reads all of it, and writes artefacts/, checkpoint/, .lock,
/// progress.ndjson and report.json, which are made here where they are missing, for the run itself can make
/// nothing beside input/, or input/ would be as open to it.
FileRules rules_of_run(const std::filesystem::path& job_folder);

/// The same for a check: check.json and, where a preview is wanted, preview/.
FileRules rules_of_check(const std::filesystem::path& job_folder, bool with_preview);

/// How report.json and check.json are written: in a sandbox of rules_of_run or rules_of_check each can only
/// be overwritten, and one that is empty stands for none.
enum class ReportWriting { replaced, in_place };

/// Clears what an earlier attempt left, in this order: artefacts/manifest.json (durably, so that its presence
/// always means that everything in it is whole), report.json, temporary files below artefacts/. Artefacts
/// themselves stay: each is replaced by rename. Creates artefacts/ where it is missing.
api::Status clear_leftovers(const JobFolder& folder, ReportWriting writing = ReportWriting::replaced);

/// input/animation.json -> the job, and what is wrong with it (also that the file is missing or too large).
/// Its size is looked at before it is read. Error: internal.
api::Result<api::ReadRequest> read_job_request(const JobFolder& folder);

/// Writes the file `path` (report.json or check.json) anew, durably.
api::Status write_report(const std::filesystem::path& path, const api::JobReport& report,
                         ReportWriting writing = ReportWriting::replaced);

/// The same without waiting for the disk, for a process that ends at once.
void write_report_in_haste(const std::filesystem::path& path, const api::JobReport& report,
                           ReportWriting writing = ReportWriting::replaced);

}  // namespace engine
