// What the kernel says of this process's memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace engine {

/// A line of /proc/self/status, in bytes: "VmHWM:" (largest resident set of this program), "VmData:" (private
/// writable memory now, what RLIMIT_DATA counts). None without /proc.
std::optional<std::uint64_t> memory_bytes_of_self(std::string_view field);

}  // namespace engine
