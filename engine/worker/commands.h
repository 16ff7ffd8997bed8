// What `keylume` does, with the engine handed in: the process around a run, and nothing of the run itself.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "api/exit_code.h"
#include "api/job_report.h"
#include "api/job_request.h"
#include "api/read_request.h"
#include "api/result.h"
#include "engine/pipeline/preview_job.h"
#include "engine/pipeline/render_view.h"
#include "engine/pipeline/run_pipeline.h"
#include "engine/worker/command_line.h"

namespace engine {

/// As engine::run_pipeline. May throw.
using Pipeline = std::function<api::Status(const api::JobRequest&, const std::filesystem::path& input_folder,
                                           const std::filesystem::path& artefacts_folder, const RunHooks&,
                                           api::JobReport&)>;

/// As engine::check_job. May throw.
using Checker = std::function<api::Status(const api::JobRequest&, const std::filesystem::path& input_folder,
                                          unsigned threads, api::JobReport&)>;

/// Why a job is refused whose animation.json is wrong, as engine::refuse_job. May throw.
using Refuser = std::function<api::Error(const api::ReadRequest&, const std::filesystem::path& input_folder,
                                         const std::function<bool()>& stop_requested)>;
/// Looks at nothing else.
api::Error refuse_as_read(const api::ReadRequest& read, const std::filesystem::path& input_folder,
                          const std::function<bool()>& stop_requested);

/// Tells two computations apart, as engine::job_fingerprint. May throw.
using Fingerprinter = std::function<api::Result<std::string>(const std::filesystem::path& input_folder)>;
/// Cannot tell: every run is another.
api::Result<std::string> unknown_fingerprint(const std::filesystem::path& input_folder);

/// As engine::render_view. May throw.
using ViewRenderer = std::function<api::Status(const api::JobRequest&, const api::ViewRequest&,
                                               const ViewFolders&, const Progress&, api::JobReport&)>;
/// Renders none.
api::Status no_view(const api::JobRequest&, const api::ViewRequest&, const ViewFolders&, const Progress&,
                    api::JobReport&);

/// As engine::preview_job. May throw.
using Previewer = std::function<api::Status(const api::JobRequest&, const std::filesystem::path& input_folder,
                                            const std::filesystem::path& file, api::JobReport&)>;
/// Shows none.
api::Status no_preview(const api::JobRequest&, const std::filesystem::path& input_folder,
                       const std::filesystem::path& file, api::JobReport&);

/// What else of the engine a command may need.
struct EngineParts {
  Refuser refuse = refuse_as_read;
  Fingerprinter fingerprint = unknown_fingerprint;
  ViewRenderer view = no_view;
  Previewer preview = no_preview;
};

/// One attempt at a job: locks the folder, clears leftovers, runs `pipeline`, writes progress.ndjson and
/// report.json. Where an earlier attempt has left all there is to make, it says so and touches nothing, but
/// for `command.again`. Returns within 1 s after SIGTERM or SIGINT, or ends the process. Call from main,
/// once. Where the folder is not ours (missing, or another worker's) nothing in it is touched.
api::ExitCode render(const RenderCommand& command, const Pipeline& pipeline, const EngineParts& parts = {});

/// Runs `checker` (or, where the command asks for it, the previewer instead) with limits on this process,
/// from which it does not recover, and writes check.json (and preview/) and nothing else: a worker may be
/// at the folder, or have finished it.
/// Ends the process with limit_exceeded when the processor time is used up. Call from main, once.
api::ExitCode check(const CheckCommand& command, const Checker& checker, const EngineParts& parts = {});

/// Renders JOB_FOLDER/views/NAME.json (api::ViewRequest) into JOB_FOLDER/views/NAME, which appears when it is
/// whole, with limits on this process from which it does not recover, and writes NAME.report.json beside it.
/// Errors as exit codes: those of a run; internal as well where the job is not rendered yet.
api::ExitCode view(const ViewCommand& command, const ViewRenderer& render);

/// Becomes `program`, in a sandbox. -> only where that failed: internal. Call from main, once.
api::ExitCode confine(const ConfineCommand& command);

/// As engine::run_bench of this program. May throw.
using Bench = std::function<api::Status(const BenchOptions&)>;

/// The whole program: `words` are argv without the program's name.
api::ExitCode run_worker(std::span<const std::string_view> words, const Pipeline& pipeline,
                         const Checker& checker, const Bench& bench, const EngineParts& parts = {});

}  // namespace engine
