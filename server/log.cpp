#include "server/log.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <mutex>

#include "api/json/json_text.h"
#include "server/text.h"

namespace server {
namespace {

std::atomic<bool> as_json = false;
thread_local std::string current_request_id;
std::atomic<std::uint64_t> lost = 0;

std::string now_text() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return utc_text(std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
}

std::string json_line(std::string_view message, std::initializer_list<LogField> fields) {
  api::Json line{{"time", now_text()}, {"message", message}};
  if (!current_request_id.empty()) line["request_id"] = current_request_id;
  for (const LogField& field : fields)
    std::visit([&](const auto& value) { line[std::string(field.name)] = value; }, field.value);
  return api::json_text(line) + "\n";
}

std::string text_of(const std::variant<std::string, std::int64_t, double>& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return text->empty() ? "-" : *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.3g", std::get<double>(value));
  return text.data();
}

std::string text_line(std::string_view message, std::initializer_list<LogField> fields) {
  std::string all(message);
  for (const LogField& field : fields) all += ", " + std::string(field.name) + " " + text_of(field.value);
  std::string line = "keylume-server: ";
  for (const char c : all) line += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return line + "\n";
}

/// Writes what can be written without waiting for a reader. With the lock held: two that both find room would
/// not both have it. -> bytes left over
std::size_t write_now(std::string_view bytes) {
  constexpr std::size_t kPieceBytes = 4096;  // what a pipe that is ready takes without waiting
  while (!bytes.empty()) {
    pollfd ready{STDERR_FILENO, POLLOUT, 0};
    if (::poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) break;
    const ssize_t count = ::write(STDERR_FILENO, bytes.data(), std::min(bytes.size(), kPieceBytes));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return bytes.size();
}

bool write_line(const std::string& line) {
  static bool cut = false;  // the last one that began ended in its middle
  const std::string text = cut ? "\n" + line : line;
  const std::size_t left = write_now(text);
  if (left < text.size()) cut = left > 0;
  return left == 0;
}

std::string line_of(std::string_view message, std::initializer_list<LogField> fields) {
  return as_json ? json_line(message, fields) : text_line(message, fields);
}

}  // namespace

void hold_standard_descriptors() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor)
    // The lowest number that is free is this one.
    if (::fcntl(descriptor, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);
}

void set_log_format(LogFormat format) {
  as_json = format == LogFormat::json || (format == LogFormat::automatic && ::isatty(STDERR_FILENO) == 0);
}

void set_log_request_id(std::string request_id) {
  current_request_id = std::move(request_id);
}

void log_line(std::string_view message) {
  log_event(message, {});
}

void log_event(std::string_view message, std::initializer_list<LogField> fields) {
  static std::mutex writing;
  static std::uint64_t told = 0;
  const std::string line = line_of(message, fields);
  const std::lock_guard lock(writing);
  if (told != lost) {
    const std::uint64_t now = lost;
    if (write_line(line_of("lines of the log were lost", {{"count", static_cast<std::int64_t>(now - told)}})))
      told = now;
  }
  if (!write_line(line)) ++lost;
}

std::uint64_t log_lines_lost() {
  return lost;
}

}  // namespace server
