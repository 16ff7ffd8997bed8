#include "server/workers/worker_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace server {
namespace {

constexpr std::size_t kTailBytes = 600;
constexpr int kPiecesAtOnce = 64;  // a flood must not keep us from watching

/// "/data/jobs/job_1/input/scene.obj" -> "input/scene.obj", the folder itself -> "."
std::string without_folder(std::string_view text, std::string_view folder) {
  std::string changed;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t found = text.find(folder, at);
    changed += text.substr(at, found - at);
    if (found == text.npos) break;
    at = found + folder.size();
    if (at < text.size() && text[at] == '/')
      ++at;
    else
      changed += '.';
  }
  return changed;
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
  std::string taken;  // at once: a path must not be in two pieces
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
  if (!taken.empty()) add(without_folder(taken, folder_));
  return open;
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
  std::string text = tail_.size() > kTailBytes ? tail_.substr(tail_.size() - kTailBytes) : tail_;
  if (text.size() == kTailBytes) {
    const std::size_t line = text.find('\n');
    if (line != text.npos && line + 1 < text.size()) text.erase(0, line + 1);
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace server
