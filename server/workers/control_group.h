// What the control group says that this process lies in, where it is one of its own: a container's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace server {

/// Memory [bytes] that all processes of the group may use together; none: no limit, or nobody says.
/// `root`: where control groups are mounted, version 2 or 1.
std::optional<std::int64_t> group_memory_limit_bytes(const std::filesystem::path& root = "/sys/fs/cgroup");

/// Processor time that all processes of the group may use together, in whole cores, rounded up; none: no
/// limit, or nobody says.
std::optional<unsigned> group_core_limit(const std::filesystem::path& root = "/sys/fs/cgroup");

/// How many processes of the group the kernel has killed so far for want of memory; 0 where nobody says.
std::int64_t out_of_memory_kills(const std::filesystem::path& root = "/sys/fs/cgroup");

}  // namespace server
