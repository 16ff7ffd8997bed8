#include <atomic>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "api/fault_point.h"
#include "api/view_request.h"
#include "engine/base/durable_file.h"
#include "engine/base/parallel.h"
#include "engine/worker/commands.h"
#include "engine/worker/job_folder.h"
#include "engine/worker/outcome.h"
#include "engine/worker/sandbox.h"
#include "engine/worker/supervision.h"
#include "engine/worker/wall_clock.h"

namespace engine {
namespace {

/// Of one picture.
constexpr std::uint64_t kViewFileBytesMax = std::uint64_t{2} << 30;

/// The files of one view.
struct ViewPaths {
  std::filesystem::path folder;     ///< JOB_FOLDER/views/NAME
  std::filesystem::path request;    ///< beside it: NAME.json
  std::filesystem::path report;     ///< NAME.report.json
  std::filesystem::path temporary;  ///< .tmp.NAME, renamed to `folder` when it is whole
};

ViewPaths paths_of(const ViewCommand& command) {
  const std::filesystem::path views = command.job_folder / "views";
  return {views / command.name, views / (command.name + ".json"), views / (command.name + ".report.json"),
          views / (".tmp." + command.name)};
}

api::Result<std::string> read_file(const std::filesystem::path& path) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed)
    return api::Error{api::Fault::not_found, "cannot read " + path.string() + ": " + failed.message()};
  if (size > api::kViewBytesMax)
    return api::Error{api::Fault::invalid_request, path.string() + " is larger than 1 MiB"};
  std::string bytes(size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size)))
    return api::Error{api::Fault::internal, "cannot read " + path.string()};
  return bytes;
}

/// An empty folder under the temporary name, whatever an earlier attempt has left there.
api::Status make_empty(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::remove_all(folder, failed);
  if (!failed) std::filesystem::create_directory(folder, failed);
  return failed ? api::Status(file_error("make", folder, failed.value())) : api::Status(api::Done{});
}

/// In place of what was there.
api::Status rename_into_place(const ViewPaths& paths) {
  std::error_code failed;
  std::filesystem::remove_all(paths.folder, failed);
  api::fault_point("view_rendered");
  if (!failed) std::filesystem::rename(paths.temporary, paths.folder, failed);
  if (failed) return file_error("rename", paths.temporary, failed.value());
  const api::Status synced = sync_folder(paths.folder.parent_path());
  api::fault_point("view_renamed");
  return synced;
}

api::Status run_view(const JobFolder& folder, const ViewPaths& paths, const ViewRenderer& render,
                     const Watch& watch, api::JobReport& report) {
  const auto read = read_job_request(folder);
  if (!read) return read.error();
  if (!read->violations.empty())
    return api::Error{api::Fault::wrong_state, "the job itself is refused; see keylume check"};
  if (!std::filesystem::exists(folder.artefacts() / "manifest.json"))
    return api::Error{api::Fault::wrong_state,
                      "the job is not rendered yet: it has no artefacts/manifest.json"};
  const auto bytes = read_file(paths.request);
  if (!bytes) return bytes.error();
  const api::JobRequest& job = read->request;
  const auto view = api::parse_view_request(*bytes, api::viewed_job(job), paths.request.filename().string());
  if (!view) return view.error();
  if (auto made = make_empty(paths.temporary); !made) return made;
  Progress progress;
  progress.stop_requested = [&watch] { return watch.stop_requested(); };
  const auto rendered =
      render(job, *view, {folder.input(), folder.artefacts(), paths.temporary}, progress, report);
  if (rendered) return rename_into_place(paths);
  std::error_code ignored;
  std::filesystem::remove_all(paths.temporary, ignored);
  return rendered;
}

void write_last_words_of_view(const ViewPaths& paths, api::ExitCode code, double wall_seconds) {
  const api::Status why =
      code == api::ExitCode::stopped
          ? api::Error{api::Fault::stopped, "told to stop"}
          : api::Error{api::Fault::out_of_resources, "the processor time allowed is used up"};
  api::JobReport report;
  complete_report(why, wall_seconds, report);
  tell_report(report);
  write_report_in_haste(paths.report, report);
}

}  // namespace

api::Status no_view(const api::JobRequest&, const api::ViewRequest&, const ViewFolders&, const Progress&,
                    api::JobReport&) {
  return api::Error{api::Fault::internal, "this program renders no views"};
}

api::ExitCode view(const ViewCommand& command, const ViewRenderer& render) {
  const Clock::time_point start = Clock::now();
  if (command.parent) {
    if (const api::Status bound = bind_to_parent(*command.parent); !bound) return give_up(bound.error());
  }
  // What was rendered stays as it is, and so do the videos.
  const api::Result<std::string> sandbox =
      command.sandbox ? enter_sandbox({.read = {command.job_folder}, .write = {command.job_folder / "views"}})
                      : std::string();
  if (!sandbox) return give_up(sandbox.error());
  const ViewPaths paths = paths_of(command);
  std::atomic<bool> ours = false;
  LastWord last_word;
  const auto watch =
      Watch::start({.end_with_stdin = command.parent.has_value(), .last_words = [&](api::ExitCode code) {
                      if (ours && !last_word.take()) return false;
                      if (ours) write_last_words_of_view(paths, code, seconds_since(start));
                      return true;
                    }});
  if (!watch) return give_up(watch.error());
  const api::Status limited = limit_myself({.memory_bytes = command.memory_mb << 20,
                                            .processor_seconds = command.seconds,
                                            .file_bytes = kViewFileBytesMax});
  if (!limited) return give_up(limited.error());
  set_thread_count(command.threads);
  // Without its lock: what a finished run has left does not change.
  const auto folder = JobFolder::look_into(command.job_folder);
  if (!folder) return give_up(folder.error());
  ours = true;

  api::JobReport report;
  report.sandbox = *sandbox;
  const api::Status status =
      without_exceptions([&] { return run_view(*folder, paths, render, **watch, report); });
  last_word.take_or_end();
  complete_report(status, seconds_since(start), report);
  tell_report(report);
  if (status) tell("the view lies in " + paths.folder.string());
  const api::Status written = write_report(paths.report, report);
  if (!written) tell(paths.report.filename().string() + ": " + written.error().message);
  return exit_code_of(status ? written : status);
}

}  // namespace engine
