#include "engine/pipeline/run_pipeline.h"

#include "api/fault_point.h"
#include "engine/base/parallel.h"
#include "engine/image/texture_file.h"
#include "engine/patches/texture_reflectance.h"
#include "engine/pipeline/forecast.h"
#include "engine/pipeline/job_fingerprint.h"
#include "engine/pipeline/prepare_job.h"
#include "engine/pipeline/publish.h"
#include "engine/pipeline/solve_sequence.h"
#include "engine/pipeline/solved_checkpoint.h"
#include "engine/pipeline/stage_clock.h"
#include "engine/scene/refuse_scene.h"

namespace engine {
namespace {

/// Fills the report's forecast, of the whole and of each stage.
MachinePace forecast_job(const PreparedJob& job, unsigned threads, api::JobReport& report) {
  const MachinePace pace = measure_pace(job.scene, job.animation, threads);
  report.forecast = forecast_of(job.size, threads, pace);
  const StageSeconds seconds = forecast_seconds(job.size, pace);
  for (std::size_t k = 0; k < seconds.size(); ++k)
    if (seconds[k] > 0)
      report.counts.emplace_back(
          "forecast_" + std::string(api::name_of(static_cast<api::Stage>(k))) + "_seconds", seconds[k]);
  return pace;
}

/// What the stages are expected to take, now and once it is known how many frames are solved.
void expect_forecast(StageClock& clock, const JobSize& size, const MachinePace& pace) {
  clock.expect(forecast_seconds(size, pace));
  clock.ask([size, pace](std::uint32_t solved_frames) {
    JobSize known = size;
    known.solved_frames = solved_frames;
    return forecast_seconds(known, pace);
  });
}

/// Where nothing is to be kept, or the inputs cannot be told apart: none.
Checkpoints open_checkpoints(const RunHooks& hooks, const std::filesystem::path& input_folder) {
  if (hooks.checkpoint_folder.empty()) return {};
  const api::Result<std::string> fingerprint =
      hooks.fingerprint.empty() ? job_fingerprint(input_folder) : hooks.fingerprint;
  return fingerprint ? Checkpoints(hooks.checkpoint_folder, *fingerprint, hooks.checkpoints_apart)
                     : Checkpoints();
}

/// As an earlier attempt left it, or solved now.
api::Result<SolvedSequence> solve_or_resume(const LitScene& lit, const api::LightingOptions& options,
                                            StageClock& clock, Checkpoints& checkpoints,
                                            api::JobReport& report) {
  if (auto solved = load_solved(checkpoints, report)) {
    report.counts.emplace_back("resumed_solution", 1);
    clock.begin(api::Stage::interpolate);
    clock.go_on_from(1, "goes on from the solution that an earlier attempt has saved");
    return std::move(*solved);
  }
  auto solved = solve_sequence(lit, options, clock, report, checkpoints);
  // Not kept (a full disk): the next attempt solves again.
  if (solved && checkpoints.due()) (void)save_solved(*solved, report, checkpoints);
  return solved;
}

}  // namespace

api::Status run_pipeline(const api::JobRequest& request, const std::filesystem::path& input_folder,
                         const std::filesystem::path& artefacts_folder, const RunHooks& hooks,
                         api::JobReport& report) {
  StageClock clock(hooks, report);
  clock.begin(api::Stage::scene);
  Checkpoints checkpoints = open_checkpoints(hooks, input_folder);
  const auto job = prepare_job(request, input_folder, hooks.stop_requested, report);
  if (!job) return job.error();
  const MachinePace pace = forecast_job(*job, thread_count(), report);
  expect_forecast(clock, job->size, pace);

  JobSize size = job->size;
  auto patches = cut_into_patches(*job, request, clock.begin(api::Stage::patches), size, report);
  if (!patches) return patches.error();
  expect_forecast(clock, size, pace);
  patches->texture_reflectance = texture_reflectance(job->scene, job->animation, *patches);
  const StaticRays static_rays(*patches, job->animation);
  const LitScene lit{job->scene, job->animation, *patches, static_rays};

  const auto solved = solve_or_resume(lit, request.lighting, clock, checkpoints, report);
  if (!solved) return solved.error();

  const auto images = publish_images(lit, solved->radiosity_w_m2, request.images, artefacts_folder,
                                     checkpoints, clock, report);
  if (!images) return images.error();
  const Progress& publishing = clock.begin(api::Stage::publish);
  const auto published = publish_data(lit, *solved, *images, request, artefacts_folder);
  if (!published) return published;
  api::fault_point("artefacts_published");
  checkpoints.clear();
  publishing.report(1);
  return published;
}

api::Status check_job(const api::JobRequest& request, const std::filesystem::path& input_folder,
                      unsigned threads, api::JobReport& report) {
  const auto job = prepare_job(
      request, input_folder, [] { return false; }, report);
  if (!job) return job.error();
  (void)forecast_job(*job, threads, report);
  return api::Done{};
}

api::Error refuse_job(const api::ReadRequest& read, const std::filesystem::path& input_folder,
                      const std::function<bool()>& stop_requested) {
  return refuse_scene(input_folder, read, {}, read_texture, stop_requested);
}

}  // namespace engine
