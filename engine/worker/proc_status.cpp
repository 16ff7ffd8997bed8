#include "engine/worker/proc_status.h"

#include <fstream>
#include <string>

namespace engine {

std::optional<std::uint64_t> memory_bytes_of_self(std::string_view field) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kib = 0;
    if (word == field && status >> kib) return kib * 1024;
  }
  return std::nullopt;
}

}  // namespace engine
