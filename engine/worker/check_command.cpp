#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/worker/commands.h"
#include "engine/worker/job_folder.h"
#include "engine/worker/outcome.h"
#include "engine/worker/sandbox.h"
#include "engine/worker/supervision.h"
#include "engine/worker/wall_clock.h"

namespace engine {
namespace {

/// Of the report and, where one is asked for, of the preview.
constexpr std::uint64_t kCheckFileBytesMax = 16u << 20;
constexpr std::uint64_t kPreviewFileBytesMax = kPreviewBytesMax + kCheckFileBytesMax;

api::Status run_check(const JobFolder& folder, const CheckCommand& command, const Checker& checker,
                      const EngineParts& parts, api::JobReport& report) {
  const auto read = read_job_request(folder);
  if (!read) return read.error();
  if (!read->violations.empty()) return parts.refuse(*read, folder.input(), [] { return false; });
  if (command.preview) {
    std::error_code failed;
    std::filesystem::create_directory(folder.preview().parent_path(), failed);
    return parts.preview(read->request, folder.input(), folder.preview(), report);
  }
  return checker(read->request, folder.input(), command.threads, report);
}

/// ": 45 polygons, 49208 patches, 120 frames"
std::string counted(const api::JobReport& report) {
  std::string text;
  for (const auto& [name, count] : report.counts) {
    if (name.ends_with("_seconds")) continue;
    text += (text.empty() ? ": " : ", ") + std::to_string(static_cast<std::uint64_t>(count)) + " " + name;
  }
  return text;
}

/// "; a run takes about 61 s and 250 MiB"
std::string forecast_text(const std::optional<api::Forecast>& forecast) {
  if (!forecast) return {};
  char text[80];
  std::snprintf(text, sizeof text, "; a run takes about %.3g s and %llu MiB", forecast->seconds,
                static_cast<unsigned long long>(forecast->memory_bytes >> 20));
  return text;
}

ReportWriting writing_of_check(const CheckCommand& command) {
  return command.sandbox ? ReportWriting::in_place : ReportWriting::replaced;
}

void write_last_words_of_check(const JobFolder& folder, api::ExitCode code, const CheckCommand& command,
                               double wall_seconds) {
  const api::Status why = code == api::ExitCode::stopped
                              ? api::Error{api::Fault::stopped, "told to stop"}
                              : api::Error{api::Fault::out_of_resources,
                                           "reading the scene takes more than " +
                                               std::to_string(command.seconds) + " s of processor time"};
  api::JobReport report;
  complete_report(why, wall_seconds, report);
  tell_report(report);
  write_report_in_haste(folder.check_report(), report, writing_of_check(command));
}

}  // namespace

api::Status no_preview(const api::JobRequest&, const std::filesystem::path&, const std::filesystem::path&,
                       api::JobReport&) {
  return api::Error{api::Fault::internal, "this program makes no previews"};
}

api::ExitCode check(const CheckCommand& command, const Checker& checker, const EngineParts& parts) {
  const Clock::time_point start = Clock::now();
  if (command.parent) {
    if (const api::Status bound = bind_to_parent(*command.parent); !bound) return give_up(bound.error());
  }
  const api::Result<std::string> sandbox =
      command.sandbox ? enter_sandbox(rules_of_check(command.job_folder, command.preview)) : std::string();
  if (!sandbox) return give_up(sandbox.error());
  std::optional<JobFolder> folder;                 // outlives the watch, which writes into it
  std::atomic<const JobFolder*> opened = nullptr;  // what the watch may write into
  LastWord last_word;
  const auto watch = Watch::start({.end_with_stdin = command.parent.has_value(),
                                   .grace = std::chrono::milliseconds(0),
                                   .last_words = [&](api::ExitCode code) {
                                     const JobFolder* mine = opened;
                                     if (mine && !last_word.take()) return false;
                                     if (mine)
                                       write_last_words_of_check(*mine, code, command, seconds_since(start));
                                     return true;
                                   }});
  if (!watch) return give_up(watch.error());
  const api::Status limited =
      limit_myself({.memory_bytes = command.memory_mb << 20,
                    .processor_seconds = command.seconds,
                    .file_bytes = command.preview ? kPreviewFileBytesMax : kCheckFileBytesMax});
  if (!limited) return give_up(limited.error());
  set_thread_count(1);  // what is allowed is processor time over all threads
  auto found = JobFolder::look_into(command.job_folder);
  if (!found) return give_up(found.error());
  opened = &folder.emplace(std::move(*found));

  api::JobReport report;
  report.sandbox = *sandbox;
  const api::Status status =
      without_exceptions([&] { return run_check(*folder, command, checker, parts, report); });
  last_word.take_or_end();
  complete_report(status, seconds_since(start), report);
  tell_report(report);
  if (status) tell("the job is sound" + counted(report) + forecast_text(report.forecast));
  const api::Status written = write_report(folder->check_report(), report, writing_of_check(command));
  if (!written) tell("check.json: " + written.error().message);
  return exit_code_of(status ? written : status);
}

}  // namespace engine
