// How an attempt ended: the exit code the supervisor reads and the lines a person reads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "api/exit_code.h"
#include "api/job_report.h"
#include "api/result.h"

namespace engine {

/// Missing input and wrong states are failures of whoever made the folder: `internal`.
api::ExitCode exit_code_of(api::Fault fault);
api::ExitCode exit_code_of(const api::Status& status);

/// Runs `work`; what it throws becomes an Error: std::bad_alloc out_of_resources, a full disk disk_full,
/// anything else internal.
api::Status without_exceptions(const std::function<api::Status()>& work);

/// Warnings in a report; where there are more, a last one says how many.
inline constexpr std::size_t kWarningsMax = 100;

/// Fills what every report ends with: outcome, message and violations of `status` (kViolationsMax at most),
/// peak memory, and "wall_seconds" among the counts. Cuts the warnings.
void complete_report(const api::Status& status, double wall_seconds, api::JobReport& report);

/// Largest resident set of this process since it was started  [bytes].
std::uint64_t peak_memory_bytes();

/// "scene.obj:12:4: vertex 99 does not exist", "animation.json /frames: must be at least 1".
std::string text_of(const api::Violation& violation);

/// One line on standard error, in one write. Throws nothing. Control characters are replaced: names come from
/// strangers.
void tell(std::string_view message);

/// Tells why an attempt cannot even begin, and answers how the process ends.
api::ExitCode give_up(const api::Error& error);

/// What a person at the terminal needs to know of `report`: the message, violations, warnings.
void tell_report(const api::JobReport& report);

}  // namespace engine
