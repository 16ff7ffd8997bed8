#include "server/log.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "api/json/json_text.h"

namespace server {
namespace {

std::atomic<bool> as_json = false;
thread_local std::string current_request_id;

std::string now_text() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  const auto seconds = static_cast<std::time_t>(ms / 1000);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text.data() + size, text.size() - size, ".%03dZ", static_cast<int>(ms % 1000));
  return text.data();
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

}  // namespace

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
  const std::string line = as_json ? json_line(message, fields) : text_line(message, fields);
  // One write, so that lines of several threads do not mix.
  (void)!::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace server
