#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <thread>

#include "server/workers/attempt.h"
#include "server/workers/child_process.h"

namespace server {
namespace {

using namespace std::chrono_literals;

constexpr auto kDeathPatience = 10s;
constexpr auto kLookIfGoneAfter = 10ms;
constexpr int kStartTimeField = 22;  // proc(5), /proc/PID/stat
constexpr int kStateField = 3;
constexpr int kUserTimeField = 14;
constexpr int kSystemTimeField = 15;

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string boot_id() {
  std::string id = read_text("/proc/sys/kernel/random/boot_id");
  while (!id.empty() && id.back() == '\n') id.pop_back();
  return id;
}

}  // namespace

api::Result<ProcessIdentity> identity_of(pid_t pid) {
  const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
  // The second field is the program's name in parentheses and may hold anything, so count from its end.
  const std::size_t name_end = stat.rfind(')');
  const api::Error gone{api::Fault::not_found, "there is no process " + std::to_string(pid)};
  if (name_end == stat.npos) return gone;
  std::istringstream fields(stat.substr(name_end + 1));
  std::string field;
  std::string state;
  for (int number = kStateField; number <= kStartTimeField && fields >> field; ++number)
    if (number == kStateField) state = field;
  ProcessIdentity identity{pid, 0, boot_id()};
  if (!fields || state == "Z" || state == "X") return gone;  // dead already, only not reaped
  std::from_chars(field.data(), field.data() + field.size(), identity.start_ticks);
  return identity;
}

std::int64_t processor_ticks_of(pid_t pid) {
  const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
  const std::size_t name_end = stat.rfind(')');
  if (name_end == stat.npos) return 0;
  std::istringstream fields(stat.substr(name_end + 1));
  std::string field;
  std::int64_t ticks = 0;
  for (int number = kStateField; number <= kSystemTimeField && fields >> field; ++number) {
    std::int64_t value = 0;
    std::from_chars(field.data(), field.data() + field.size(), value);
    if (number >= kUserTimeField) ticks += value;
  }
  return ticks;
}

std::int64_t peak_bytes_of(pid_t pid) {
  constexpr std::string_view kField = "\nVmHWM:";
  const std::string status = read_text("/proc/" + std::to_string(pid) + "/status");
  const std::size_t at = status.find(kField);
  if (at == status.npos) return 0;
  std::int64_t kib = 0;
  std::istringstream(status.substr(at + kField.size())) >> kib;
  return kib * 1024;
}

api::Status kill_and_confirm(const ProcessIdentity& process) {
  const auto pid = static_cast<pid_t>(process.pid);
  const auto deadline = std::chrono::steady_clock::now() + kDeathPatience;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto now = identity_of(pid);
    if (!now || now->start_ticks != process.start_ticks || now->boot_id != process.boot_id)
      return api::Done{};
    if (::kill(-pid, SIGKILL) != 0 && ::kill(pid, SIGKILL) != 0 && errno == EPERM)
      return api::Error{api::Fault::internal, "process " + std::to_string(pid) + " cannot be killed"};
    std::this_thread::sleep_for(kLookIfGoneAfter);
  }
  return api::Error{api::Fault::internal, "process " + std::to_string(pid) + " does not die"};
}

}  // namespace server
