#include "server/workers/worker_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "server/jobs/without_folder.h"

namespace server {
namespace {

constexpr std::size_t kTailBytes = 600;
constexpr int kPiecesAtOnce = 64;  // a flood must not keep us from watching

/// How many bytes at the end of `text` may be the beginning of a path in `folder`, up to the name in there.
std::size_t begun_at_end(std::string_view text, const std::string& folder) {
  const std::string within = folder + "/";
  for (std::size_t bytes = std::min(text.size(), within.size()); bytes > 0; --bytes)
    if (text.ends_with(std::string_view(within).substr(0, bytes))) return bytes;
  return 0;
}

}  // namespace

WorkerLog::WorkerLog(const std::filesystem::path& job_folder, std::string_view title)
    : folder_(job_folder.string()),
      // O_NONBLOCK: a pipe that a worker put in its place must not hang us.
      file_(::open((job_folder / "worker.log").c_str(),
                   O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600)) {
  if (file_) (void)write_all(file_, "--- " + std::string(title) + "\n");
}

bool WorkerLog::take_from(const FileHandle& output) {
  std::array<char, 4096> piece{};
  std::string taken = std::move(held_);
  bool open = true;
  for (int i = 0; i < kPiecesAtOnce; ++i) {
    const ssize_t count = ::read(output.get(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      open = count < 0 && errno == EAGAIN;
      break;
    }
    taken.append(piece.data(), static_cast<std::size_t>(count));
  }
  // A path may come in two pieces: what may be the beginning of one waits for the rest.
  const std::size_t begun = open ? begun_at_end(taken, folder_) : 0;
  held_ = taken.substr(taken.size() - begun);
  taken.resize(taken.size() - begun);
  if (!taken.empty()) add(without_folder(taken, folder_));
  return open;
}

WorkerLog::~WorkerLog() {
  if (const std::string rest = what_is_held(); !rest.empty()) add(rest);
}

// Half a path that nothing came after says where the folder lies as well as all of it.
std::string WorkerLog::what_is_held() const {
  if (held_ == "/") return held_;
  return held_.starts_with(folder_) ? "." : "";
}

void WorkerLog::add(std::string_view text) {
  tail_ += text;
  if (tail_.size() > 2 * kTailBytes) tail_.erase(0, tail_.size() - kTailBytes);
  if (cut_ || !file_) return;
  written_ += static_cast<std::int64_t>(text.size());
  cut_ = written_ > kAttemptBytesMax;
  (void)write_all(file_,
                  cut_ ? std::string_view("\n--- the rest of this attempt's output is left out\n") : text);
}

std::string WorkerLog::tail() const {
  const std::string all = tail_ + what_is_held();
  std::string text = all.size() > kTailBytes ? all.substr(all.size() - kTailBytes) : all;
  if (text.size() == kTailBytes) {
    const std::size_t line = text.find('\n');
    if (line != text.npos && line + 1 < text.size()) text.erase(0, line + 1);
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace server
