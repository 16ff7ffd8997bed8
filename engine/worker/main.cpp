// keylume: the worker. One process per attempt at a job; README and `keylume --help` say how to use it.
#include <exception>
#include <new>
#include <string_view>
#include <vector>

#include "engine/bench/bench.h"
#include "engine/pipeline/job_fingerprint.h"
#include "engine/pipeline/preview_job.h"
#include "engine/pipeline/render_view.h"
#include "engine/pipeline/run_pipeline.h"
#include "engine/worker/commands.h"
#include "engine/worker/outcome.h"

int main(int argc, char** argv) {
  try {
    const std::vector<std::string_view> words(argv + (argc > 0 ? 1 : 0), argv + argc);
    const engine::Bench bench = [](const engine::BenchOptions& options) {
      return engine::run_bench(options, engine::this_program());
    };
    return static_cast<int>(engine::run_worker(words, engine::run_pipeline, engine::check_job, bench,
                                               {.refuse = engine::refuse_job,
                                                .fingerprint = engine::job_fingerprint,
                                                .view = engine::render_view,
                                                .preview = engine::preview_job}));
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
