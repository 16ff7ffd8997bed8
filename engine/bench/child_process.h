// A program run to its end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "api/result.h"

namespace engine {

/// What a child may take; 0: as much as it likes.
struct ChildLimits {
  double seconds = 0;              ///< then it is told to stop (SIGTERM)
  std::uint64_t memory_bytes = 0;  ///< of private memory; then it gets no more
};

struct ChildUse {
  double cpu_s = 0;                     ///< of all its threads, user and system  [s]
  std::uint64_t peak_memory_bytes = 0;  ///< largest resident set
};

/// Runs words[0] with the others as arguments and waits. Standard output and error go to the file `log`,
/// standard input is empty. Error: internal where it cannot be started, or ends with another status than 0;
/// the message ends with the last line of the log. out_of_resources where it took too long.
api::Result<ChildUse> run_child(const std::vector<std::string>& words, const std::filesystem::path& log,
                                const ChildLimits& limits = {});

}  // namespace engine
