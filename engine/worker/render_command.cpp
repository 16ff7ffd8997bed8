#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/worker/commands.h"
#include "engine/worker/finished_run.h"
#include "engine/worker/job_folder.h"
#include "engine/worker/outcome.h"
#include "engine/worker/progress_file.h"
#include "engine/worker/sandbox.h"
#include "engine/worker/supervision.h"
#include "engine/worker/wall_clock.h"

namespace engine {
namespace {

std::string text_of_seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

/// Tells a person what changes: each new stage and each new message.
class Narrator {
 public:
  explicit Narrator(Clock::time_point start) : start_(start) {}

  void hear(const api::ProgressLine& line) {
    if (stage_ != line.stage)
      tell(text_of_seconds(seconds_since(start_)) + "  " + std::string(name_of(line.stage)));
    if (!line.message.empty() && line.message != message_) tell(line.message);
    stage_ = line.stage;
    message_ = line.message;
  }

 private:
  Clock::time_point start_;
  std::optional<api::Stage> stage_;
  std::string message_;
};

/// Has an earlier run left all there is to make? Tells what it finds.
bool is_done(const JobFolder& folder, const std::string& fingerprint) {
  switch (look_for_earlier_run(folder, fingerprint)) {
    case EarlierRun::none:
      return false;
    case EarlierRun::whole:
      tell("already rendered, nothing to do; --again renders it again");
      return true;
    case EarlierRun::of_other:
      tell("another job was rendered here, or by another program; rendering anew");
      return false;
    case EarlierRun::damaged:
      tell("this job was rendered, but not all of its artefacts are whole; rendering anew");
      return false;
  }
  return false;
}

/// Empty: cannot be told.
std::string fingerprint_of(const JobFolder& folder, const Fingerprinter& fingerprinter) {
  std::string text;
  (void)without_exceptions([&]() -> api::Status {
    if (const auto fingerprint = fingerprinter(folder.input())) text = *fingerprint;
    return api::Done{};
  });
  return text;
}

ReportWriting writing_of(const RenderCommand& command) {
  return command.sandbox ? ReportWriting::in_place : ReportWriting::replaced;
}

api::Status run_attempt(const JobFolder& folder, const RenderCommand& command, const Pipeline& pipeline,
                        const Refuser& refuser, const std::string& fingerprint, const Watch& watch,
                        Clock::time_point start, api::JobReport& report) {
  if (const api::Status cleared = clear_leftovers(folder, writing_of(command)); !cleared) return cleared;
  const auto stop_requested = [&] { return watch.stop_requested(); };
  const auto read = read_job_request(folder);
  if (!read) return read.error();
  if (!read->violations.empty()) return refuser(*read, folder.input(), stop_requested);
  const auto progress = ProgressFile::open(folder.progress());
  if (!progress) return progress.error();

  Narrator narrator(start);
  RunHooks hooks;
  hooks.progress = [&](const api::ProgressLine& line) {
    (*progress)->report(line);
    narrator.hear(line);
  };
  hooks.stop_requested = stop_requested;
  hooks.checkpoint_folder = folder.checkpoint();
  hooks.fingerprint = fingerprint;
  hooks.checkpoints_apart = std::chrono::seconds(command.checkpoint_seconds);
  return pipeline(read->request, folder.input(), folder.artefacts(), hooks, report);
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

/// How good the result is, where that was estimated.
void tell_noise(const api::JobReport& report) {
  if (!report.noise) return;
  std::string text = "noise " + percent(*report.noise) + " of the mean radiosity";
  if (report.target_error && report.target_error_met)
    text += "; the target error of " + percent(*report.target_error) + " is " +
            (*report.target_error_met ? "met" : "missed");
  tell(text);
}

/// The report of a process that ends in the midst of its work. Another thread fills the real one: not
/// touched.
void write_last_words(const JobFolder& folder, const RenderCommand& command, api::ExitCode code,
                      double wall_seconds) {
  const api::Status why =
      code == api::ExitCode::stopped
          ? api::Error{api::Fault::stopped, "told to stop, and ended before the stage at work noticed"}
          : api::Error{api::Fault::out_of_resources, "the processor time allowed is used up"};
  api::JobReport report;
  complete_report(why, wall_seconds, report);
  tell_report(report);
  write_report_in_haste(folder.report(), report, writing_of(command));
}

api::ExitCode conclude(const JobFolder& folder, const RenderCommand& command, const api::Status& status,
                       double wall_seconds, api::JobReport& report) {
  complete_report(status, wall_seconds, report);
  tell_report(report);
  const api::Status written = write_report(folder.report(), report, writing_of(command));
  if (!written) tell("report.json: " + written.error().message);
  if (!status) return exit_code_of(status);
  tell_noise(report);
  if (written)
    tell("succeeded in " + text_of_seconds(wall_seconds) + ", peak memory " +
         std::to_string(report.peak_memory_bytes >> 20) + " MiB");
  return exit_code_of(written);
}

}  // namespace

api::ExitCode render(const RenderCommand& command, const Pipeline& pipeline, const EngineParts& parts) {
  const Clock::time_point start = Clock::now();
  if (command.parent) {
    if (const api::Status bound = bind_to_parent(*command.parent); !bound) return give_up(bound.error());
  }
  const api::Result<std::string> sandbox =
      command.sandbox ? enter_sandbox(rules_of_run(command.job_folder)) : std::string();
  if (!sandbox) return give_up(sandbox.error());
  std::optional<JobFolder> folder;                 // outlives the watch, which writes into it
  std::atomic<const JobFolder*> locked = nullptr;  // the watch must not write into a folder that is not ours
  LastWord last_word;
  const auto watch =
      Watch::start({.end_with_stdin = command.parent.has_value(), .last_words = [&](api::ExitCode code) {
                      const JobFolder* mine = locked;
                      if (mine && !last_word.take()) return false;
                      if (mine) write_last_words(*mine, command, code, seconds_since(start));
                      return true;
                    }});
  if (!watch) return give_up(watch.error());
  set_thread_count(command.threads);
  auto opened = JobFolder::open(command.job_folder);
  if (!opened) return give_up(opened.error());
  folder.emplace(std::move(*opened));
  const std::string fingerprint = fingerprint_of(*folder, parts.fingerprint);
  bool done = false;
  (void)without_exceptions([&]() -> api::Status {
    done = !command.again && !fingerprint.empty() && is_done(*folder, fingerprint);
    return api::Done{};
  });
  if (done) return api::ExitCode::ok;
  locked = &*folder;  // not before: being stopped must not replace the report of a run that is done

  api::JobReport report;
  report.sandbox = *sandbox;
  const api::Status status = without_exceptions([&] {
    return run_attempt(*folder, command, pipeline, parts.refuse, fingerprint, **watch, start, report);
  });
  last_word.take_or_end();
  if (status) report.fingerprint = fingerprint;
  return conclude(*folder, command, status, seconds_since(start), report);
}

}  // namespace engine
