// Keeps what a worker writes to its standard output and error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "server/artefacts/files.h"

namespace server {

/// Appends to worker.log in the job folder, at most kAttemptBytesMax per attempt, and remembers the end.
/// Where that folder lies is nobody's business who reads it: paths in there are told from there.
class WorkerLog {
 public:
  static constexpr std::int64_t kAttemptBytesMax = 1 << 20;

  /// Begins with a line that names what follows. A log that cannot be written is no reason to stop a job.
  WorkerLog(const std::filesystem::path& job_folder, std::string_view title);
  ~WorkerLog();
  WorkerLog(const WorkerLog&) = delete;
  WorkerLog& operator=(const WorkerLog&) = delete;

  /// Takes what `output` holds now, or a good part of it, without waiting; false at its end.
  bool take_from(const FileHandle& output);

  /// Last bytes written, from the start of a line where possible, without the newline at the end.
  std::string tail() const;

 private:
  void add(std::string_view text);
  std::string what_is_held() const;

  std::string folder_;
  FileHandle file_;
  std::int64_t written_ = 0;
  bool cut_ = false;
  std::string tail_;
  std::string held_;  ///< that came last, and may be the beginning of a path
};

}  // namespace server
