#include "server/workers/control_group.h"

#include <fstream>
#include <string>

namespace server {
namespace {

/// The number after `name` in a file of lines "name number".
std::optional<std::int64_t> number_after(const std::filesystem::path& file, std::string_view name) {
  std::ifstream lines(file);
  std::string word;
  std::int64_t number = 0;
  while (lines >> word >> number)
    if (word == name) return number;
  return std::nullopt;
}

}  // namespace

std::optional<std::int64_t> group_memory_limit_bytes(const std::filesystem::path& root) {
  // Without a limit version 2 says "max", which is no number, and version 1 more than any machine has.
  for (const char* file : {"memory.max", "memory/memory.limit_in_bytes"}) {
    std::int64_t limit = 0;
    if (std::ifstream(root / file) >> limit && limit > 0 && limit < INT64_MAX / 2) return limit;
  }
  return std::nullopt;
}

std::int64_t out_of_memory_kills(const std::filesystem::path& root) {
  if (const auto kills = number_after(root / "memory.events", "oom_kill")) return *kills;
  return number_after(root / "memory/memory.oom_control", "oom_kill").value_or(0);
}

}  // namespace server
