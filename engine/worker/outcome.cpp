#include "engine/worker/outcome.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>

#include "api/refusal_text.h"
#include "engine/worker/commands.h"
#include "engine/worker/proc_status.h"

namespace engine {
namespace {

std::string_view outcome_name(const api::Status& status) {
  if (status) return "succeeded";
  return status.error().fault == api::Fault::stopped ? "stopped" : "failed";
}

bool means_full_disk(const std::error_code& code) {
  // Compared by number: std::errc has no name for EDQUOT, so the system's category does not map it.
  return (code.category() == std::generic_category() || code.category() == std::system_category()) &&
         (code.value() == ENOSPC || code.value() == EDQUOT);
}

void cut_warnings(std::vector<std::string>& warnings) {
  if (warnings.size() <= kWarningsMax) return;
  const std::size_t more = warnings.size() - kWarningsMax;
  warnings.resize(kWarningsMax);
  warnings.push_back("and " + std::to_string(more) + " more");
}

}  // namespace

api::ExitCode exit_code_of(api::Fault fault) {
  switch (fault) {
    case api::Fault::invalid_request:
      return api::ExitCode::invalid_input;
    case api::Fault::out_of_resources:
      return api::ExitCode::limit_exceeded;
    case api::Fault::stopped:
      return api::ExitCode::stopped;
    case api::Fault::disk_full:
      return api::ExitCode::disk_full;
    case api::Fault::not_found:
    case api::Fault::wrong_state:
    case api::Fault::changed:
    case api::Fault::too_many:
    case api::Fault::over_quota:
    case api::Fault::internal:
      break;
  }
  return api::ExitCode::internal;
}

api::ExitCode exit_code_of(const api::Status& status) {
  return status ? api::ExitCode::ok : exit_code_of(status.error().fault);
}

api::Status without_exceptions(const std::function<api::Status()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return api::Error{api::Fault::out_of_resources, "the job needs more memory than it may have"};
  } catch (const std::system_error& error) {
    return api::Error{means_full_disk(error.code()) ? api::Fault::disk_full : api::Fault::internal,
                      error.what()};
  } catch (const std::exception& error) {
    return api::Error{api::Fault::internal, std::string("unexpected failure: ") + error.what()};
  } catch (...) {
    return api::Error{api::Fault::internal, "unexpected failure"};
  }
}

api::Error refuse_as_read(const api::ReadRequest& read, const std::filesystem::path&,
                          const std::function<bool()>&) {
  return {api::Fault::invalid_request, api::refusal_text("animation.json", read.violations.size()),
          read.violations};
}

api::Result<std::string> unknown_fingerprint(const std::filesystem::path&) {
  return std::string();
}

void complete_report(const api::Status& status, double wall_seconds, api::JobReport& report) {
  report.outcome = outcome_name(status);
  report.message = status ? "" : status.error().message;
  report.violations = status ? std::vector<api::Violation>{} : status.error().violations;
  if (report.violations.size() > api::kViolationsMax) report.violations.resize(api::kViolationsMax);
  cut_warnings(report.warnings);
  report.peak_memory_bytes = peak_memory_bytes();
  report.counts.emplace_back("wall_seconds", wall_seconds);
}

std::uint64_t peak_memory_bytes() {
  // getrusage would count the process that started us: a spawned child inherits its parent's peak until
  // exec, and ru_maxrss keeps it. VmHWM belongs to this program's own address space.
  if (const auto bytes = memory_bytes_of_self("VmHWM:")) return *bytes;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string text_of(const api::Violation& violation) {
  std::string text = violation.file;
  if (violation.line > 0) text += ':' + std::to_string(violation.line);
  if (violation.line > 0 && violation.column > 0) text += ':' + std::to_string(violation.column);
  if (!violation.pointer.empty()) text += (text.empty() ? "" : " ") + violation.pointer;
  return text.empty() ? violation.detail : text + ": " + violation.detail;
}

void tell(std::string_view message) {
  // Nothing can be done where standard error is closed or full.
  [[maybe_unused]] ssize_t written = 0;
  try {
    std::string line = "keylume: " + std::string(message);
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    line += '\n';
    written = write(STDERR_FILENO, line.data(), line.size());
  } catch (const std::bad_alloc&) {
    constexpr std::string_view kOutOfMemory = "keylume: out of memory\n";
    written = write(STDERR_FILENO, kOutOfMemory.data(), kOutOfMemory.size());
  }
}

api::ExitCode give_up(const api::Error& error) {
  tell(error.message);
  return exit_code_of(error.fault);
}

void tell_report(const api::JobReport& report) {
  for (const std::string& warning : report.warnings) tell("warning: " + warning);
  for (const api::Violation& violation : report.violations) tell(text_of(violation));
  const bool said = report.violations.size() == 1 && report.message == text_of(report.violations[0]);
  if (!report.message.empty() && !said) tell(report.outcome + ": " + report.message);
}

}  // namespace engine
