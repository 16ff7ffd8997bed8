// Looks at an upload without letting a stranger's file near the server: `keylume check` in a process of its
// own.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "server/jobs/job_service.h"

namespace server {

struct CheckRules {
  std::filesystem::path program;   ///< the worker executable
  std::uint64_t memory_mb = 2048;  ///< of private memory, kept by the worker itself
  std::uint64_t processor_seconds = 60;
  unsigned render_threads = 0;                 ///< that the forecast is for; 0: all cores
  std::chrono::milliseconds time_max{90'000};  ///< wall clock; killed after it
  std::ptrdiff_t at_once = 2;                  ///< further checks wait
};

/// Both wait for the same places.
struct Checks {
  CheckJob check, preview;
};

/// The checks to be handed to JobService. Safe for use by several threads; they answer
/// invalid_request with the worker's violations, out_of_resources where the limits were exceeded or too many
/// checks wait, internal where the worker failed.
Checks make_checks(const CheckRules& rules);
CheckJob make_check(const CheckRules& rules);

}  // namespace server
