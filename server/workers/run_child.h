// A child process from start to death, for callers that wait for it.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "server/workers/child_process.h"

namespace server {

struct ChildTask {
  std::filesystem::path program;
  std::vector<std::string> arguments;
  ChildLimits limits;
  std::chrono::milliseconds time_max{600'000};  ///< wall clock; killed after it
  std::filesystem::path log_folder;             ///< worker.log in it gets what the child writes
  std::string_view log_title;
};

struct ChildOutcome {
  ProcessEnd end;
  std::string log_tail;
};

/// The thread that calls lives as long as the child. Errors: those of ChildProcess::start; out_of_resources
/// where it took too long; stopped.
api::Result<ChildOutcome> run_child(const ChildTask& task, const std::atomic<bool>& stopping);

}  // namespace server
