// keylume: the worker. One process per attempt at a job; README and `keylume --help` say how to use it.
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <string_view>
#include <vector>

#include "engine/bench/bench.h"
#include "engine/pipeline/as_sent.h"
#include "engine/pipeline/job_fingerprint.h"
#include "engine/pipeline/preview_job.h"
#include "engine/pipeline/render_view.h"
#include "engine/pipeline/run_pipeline.h"
#include "engine/worker/commands.h"
#include "engine/worker/outcome.h"

namespace {

namespace fs = std::filesystem;

api::Status run(const api::JobRequest& request, const fs::path& input, const fs::path& artefacts,
                const engine::RunHooks& hooks, api::JobReport& report) {
  return engine::as_sent(input, engine::run_pipeline(request, input, artefacts, hooks, report), report);
}

api::Status check(const api::JobRequest& request, const fs::path& input, unsigned threads,
                  api::JobReport& report) {
  return engine::as_sent(input, engine::check_job(request, input, threads, report), report);
}

api::Error refuse(const api::ReadRequest& read, const fs::path& input,
                  const std::function<bool()>& stop_requested) {
  return engine::as_sent(input, engine::refuse_job(read, input, stop_requested));
}

api::Status preview(const api::JobRequest& request, const fs::path& input, const fs::path& file,
                    api::JobReport& report) {
  return engine::as_sent(input, engine::preview_job(request, input, file, report), report);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string_view> words(argv + (argc > 0 ? 1 : 0), argv + argc);
    const engine::Bench bench = [](const engine::BenchOptions& options) {
      return engine::run_bench(options, engine::this_program());
    };
    return static_cast<int>(engine::run_worker(words, run, check, bench,
                                               {.refuse = refuse,
                                                .fingerprint = engine::job_fingerprint,
                                                .view = engine::render_view,
                                                .preview = preview}));
  } catch (const std::bad_alloc&) {
    engine::tell("out of memory");
    return static_cast<int>(api::ExitCode::limit_exceeded);
  } catch (const std::exception& error) {
    engine::tell(error.what());
  } catch (...) {
    engine::tell("unexpected failure");
  }
  return static_cast<int>(api::ExitCode::internal);
}
