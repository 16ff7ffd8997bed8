#include "engine/worker/progress_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <new>
#include <string>

#include "engine/base/durable_file.h"

namespace engine {
namespace {

/// Not a number counts as nothing done yet.
double held_to_unit(double fraction) {
  return fraction > 0 ? std::min(fraction, 1.0) : 0.0;
}

/// A line that is told later than it was made: of the time that was left, so much has passed.
api::ProgressLine aged(api::ProgressLine line, std::chrono::duration<double> age) {
  if (line.seconds_left) line.seconds_left = std::max(*line.seconds_left - age.count(), 0.0);
  return line;
}

bool ends_with_newline(int file) {
  struct stat about {};
  char last = '\n';
  if (fstat(file, &about) != 0 || about.st_size == 0) return true;
  return pread(file, &last, 1, about.st_size - 1) == 1 && last == '\n';
}

}  // namespace

api::Result<std::unique_ptr<ProgressFile>> ProgressFile::open(const std::filesystem::path& path,
                                                              ProgressPace pace) {
  const int file = ::open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (file < 0) return file_error("append to", path, errno);
  return std::unique_ptr<ProgressFile>(new ProgressFile(file, ends_with_newline(file), pace));
}

ProgressFile::ProgressFile(int file, bool at_line_start, ProgressPace pace)
    : file_(file), pace_(pace), at_line_start_(at_line_start), pacer_([this] { keep_pace(); }) {}

ProgressFile::~ProgressFile() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    if (unwritten_) write_newest();
  }
  changed_.notify_all();
  pacer_.join();
  close(file_);
}

void ProgressFile::report(api::ProgressLine line) {
  const std::lock_guard lock(mutex_);
  const bool new_stage = !newest_ || newest_->stage != line.stage;
  line.stage_fraction = held_to_unit(line.stage_fraction);
  line.fraction = std::max(held_to_unit(line.fraction), newest_ ? newest_->fraction : 0.0);
  const bool pacer_knows = newest_ && unwritten_;
  newest_ = std::move(line);
  newest_came_ = Clock::now();
  unwritten_ = true;
  if (new_stage || Clock::now() - last_written_ >= pace_.apart) write_newest();
  if (!pacer_knows) changed_.notify_all();
}

void ProgressFile::keep_pace() {
  std::unique_lock lock(mutex_);
  while (!closing_) {
    if (!newest_) {
      changed_.wait(lock);
      continue;
    }
    const auto due = last_written_ + (unwritten_ ? pace_.apart : pace_.heartbeat);
    if (Clock::now() < due) {
      changed_.wait_until(lock, due);
      continue;
    }
    try {
      write_newest();
    } catch (const std::bad_alloc&) {
      // The job's own thread meets the same shortage and reports it.
    }
  }
}

void ProgressFile::write_newest() {
  unwritten_ = false;
  last_written_ = Clock::now();
  // A leading newline ends a line that a crash or a full disk cut off.
  std::string line(at_line_start_ ? "" : "\n");
  line += api::progress_line_json(aged(*newest_, last_written_ - newest_came_)) + '\n';
  ssize_t written = -1;
  do written = write(file_, line.data(), line.size());
  while (written < 0 && errno == EINTR);
  if (written > 0) at_line_start_ = static_cast<std::size_t>(written) == line.size();
}

}  // namespace engine
