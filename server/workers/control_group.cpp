#include "server/workers/control_group.h"

#include <algorithm>
#include <climits>
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

std::optional<unsigned> group_core_limit(const std::filesystem::path& root) {
  std::int64_t quota_us = 0, period_us = 0;
  // Without a limit version 2 says "max", which is no number, and version 1 a quota of -1.
  const bool known = (std::ifstream(root / "cpu.max") >> quota_us >> period_us) ||
                     ((std::ifstream(root / "cpu/cpu.cfs_quota_us") >> quota_us) &&
                      (std::ifstream(root / "cpu/cpu.cfs_period_us") >> period_us));
  if (!known || quota_us <= 0 || period_us <= 0) return std::nullopt;
  const std::int64_t cores = quota_us / period_us + (quota_us % period_us > 0 ? 1 : 0);
  return static_cast<unsigned>(std::min<std::int64_t>(cores, UINT_MAX));
}

std::int64_t out_of_memory_kills(const std::filesystem::path& root) {
  if (const auto kills = number_after(root / "memory.events", "oom_kill")) return *kills;
  return number_after(root / "memory/memory.oom_control", "oom_kill").value_or(0);
}

}  // namespace server
