// Follows progress.ndjson as the worker appends to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "api/progress_line.h"
#include "server/artefacts/files.h"

namespace server {

/// Starts at the file's present end: earlier lines are of earlier attempts. The worker is not trusted: lines
/// that are too long or no progress lines are skipped and counted, and `flooded` tells when there is no end
/// of them.
class ProgressTail {
 public:
  explicit ProgressTail(std::filesystem::path job_folder);

  struct News {
    bool alive = false;                       ///< any good line came
    std::optional<api::ProgressLine> newest;  ///< the last of them
  };
  /// What was appended since the last call, as far as it is whole lines; at most kReadBytesMax of it.
  News read();

  bool flooded() const;

 private:
  void take_line(std::string_view line, News& news);

  std::filesystem::path job_folder_;
  FileHandle file_;
  std::int64_t start_ = 0;
  std::int64_t offset_ = 0;
  std::int64_t written_ = 0;  ///< in this attempt
  std::string partial_;
  bool skipping_ = false;  ///< within a line that is too long
  std::uint32_t bad_lines_ = 0;
};

}  // namespace server
