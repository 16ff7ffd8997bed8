// A program run to its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "api/result.h"

namespace engine {

/// Runs words[0] with the others as arguments and waits. Standard output and error go to the file `log`,
/// standard input is empty. Error: internal where it cannot be started, or ends with another status than 0;
/// the message ends with the last line of the log.
api::Status run_child(const std::vector<std::string>& words, const std::filesystem::path& log);

}  // namespace engine
