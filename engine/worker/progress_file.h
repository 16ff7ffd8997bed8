// JOB_FOLDER/progress.ndjson: what the worker says while it works, and that it is alive.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "api/progress_line.h"
#include "api/result.h"

namespace engine {

struct ProgressPace {
  /// Lines of one stage are at least this far apart; of those in between the newest is written when the time
  /// has come. A new stage is written at once.
  std::chrono::milliseconds apart{100};
  /// After this long without a line the newest is repeated. Readers may take 5 s of silence for death.
  std::chrono::milliseconds heartbeat{4000};
};

/// Appends whole lines, each in one write. Later attempts append to the lines of earlier ones; where one
/// was cut off by a crash, the next line still begins on a line of its own.
class ProgressFile {
 public:
  static api::Result<std::unique_ptr<ProgressFile>> open(const std::filesystem::path& path,
                                                         ProgressPace pace = {});
  ProgressFile(const ProgressFile&) = delete;
  ~ProgressFile();  ///< writes the newest line if it is not written yet

  /// Any thread. The fractions are held to 0 .. 1, and that of the job never falls. A line that cannot be
  /// written (disk full) is dropped: progress is no reason to fail, and the artefacts meet the same disk.
  void report(api::ProgressLine line);

 private:
  using Clock = std::chrono::steady_clock;

  ProgressFile(int file, bool at_line_start, ProgressPace pace);
  void keep_pace();
  void write_newest();  ///< mutex_ held

  const int file_;
  const ProgressPace pace_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<api::ProgressLine> newest_;
  bool unwritten_ = false;
  bool at_line_start_;
  bool closing_ = false;
  Clock::time_point newest_came_{};
  Clock::time_point last_written_{};
  std::thread pacer_;
};

}  // namespace engine
