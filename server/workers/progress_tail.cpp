#include "server/workers/progress_tail.h"

#include <unistd.h>

#include <cmath>
#include <utility>
#include <vector>

#include "server/jobs/without_folder.h"

namespace server {
namespace {

constexpr std::string_view kFile = "progress.ndjson";
constexpr std::size_t kLineBytesMax = 64 * 1024;
constexpr std::size_t kReadBytesMax = 256 * 1024;
constexpr std::int64_t kAttemptBytesMax = 64 << 20;
constexpr std::uint32_t kBadLinesMax = 1000;
constexpr std::size_t kMessageBytesMax = 500;

}  // namespace

ProgressTail::ProgressTail(std::filesystem::path job_folder) : job_folder_(std::move(job_folder)) {
  auto file = open_below(job_folder_, kFile);
  if (!file) return;  // there is none before the first attempt
  file_ = std::move(*file);
  if (const auto size = size_of(file_)) start_ = offset_ = *size;
}

ProgressTail::News ProgressTail::read() {
  News news;
  if (!file_) {
    if (auto file = open_below(job_folder_, kFile)) file_ = std::move(*file);
    if (!file_) return news;
  }
  // A worker writes faster than we read: what counts is what it has written.
  if (const auto size = size_of(file_)) written_ = *size - start_;
  std::vector<char> bytes(kReadBytesMax);
  const ssize_t count = ::pread(file_.get(), bytes.data(), bytes.size(), offset_);
  if (count <= 0) return news;
  offset_ += count;
  std::string_view rest(bytes.data(), static_cast<std::size_t>(count));
  for (std::size_t end; (end = rest.find('\n')) != rest.npos; rest.remove_prefix(end + 1)) {
    partial_ += rest.substr(0, end);
    if (!std::exchange(skipping_, false)) take_line(partial_, news);
    partial_.clear();
  }
  partial_ += rest;
  if (partial_.size() > kLineBytesMax) {
    partial_.clear();
    if (!std::exchange(skipping_, true)) ++bad_lines_;
  }
  return news;
}

bool ProgressTail::flooded() const {
  return written_ > kAttemptBytesMax || bad_lines_ > kBadLinesMax;
}

void ProgressTail::take_line(std::string_view line, News& news) {
  if (line.empty()) return;
  auto parsed = api::parse_progress_line(line);
  if (!parsed) {
    ++bad_lines_;
    return;
  }
  parsed->message = without_folder(parsed->message, job_folder_.string());
  if (parsed->message.size() > kMessageBytesMax) parsed->message.resize(kMessageBytesMax);
  news.alive = true;
  news.newest = std::move(*parsed);
}

}  // namespace server
