#include "engine/pipeline/run_pipeline.h"

#include "api/fault_point.h"
#include "engine/animation/check_light_groups.h"
#include "engine/base/parallel.h"
#include "engine/image/texture_file.h"
#include "engine/patches/texture_reflectance.h"
#include "engine/pipeline/check_poses.h"
#include "engine/pipeline/forecast.h"
#include "engine/pipeline/job_fingerprint.h"
#include "engine/pipeline/limits.h"
#include "engine/pipeline/publish.h"
#include "engine/pipeline/refine_patches.h"
#include "engine/pipeline/solve_sequence.h"
#include "engine/pipeline/solved_checkpoint.h"
#include "engine/pipeline/stage_clock.h"
#include "engine/scene/refuse_scene.h"

namespace engine {
namespace {

/// What a job is about, checked and not yet cut into patches.
struct PreparedJob {
  Scene scene;
  Animation animation;
  JobSize size;
};

void count_scene(const Scene& scene, const PatchCount& count, std::uint32_t frames, api::JobReport& report) {
  if (count.dropped_facets > 0)
    report.warnings.push_back(std::to_string(count.dropped_facets) +
                              (count.dropped_facets == 1 ? " sliver" : " slivers") +
                              " of polygons without an area left out");
  report.counts.emplace_back("polygons", static_cast<double>(scene.polygons.size()));
  report.counts.emplace_back("patches", static_cast<double>(count.patches));
  report.counts.emplace_back("frames", frames);
}

/// All that can refuse a job, before anything that takes long or much memory.
api::Result<PreparedJob> prepare(const api::JobRequest& request, const std::filesystem::path& input_folder,
                                 const std::function<bool()>& stop_requested, api::JobReport& report) {
  auto scene = load_scene(input_folder, request.scene, {}, read_texture, stop_requested);
  if (!scene) return scene.error();
  report.warnings = scene->warnings;
  if (auto s = check_request_size(request, scene->objects.size()); !s) return s.error();
  Animation animation = animate(*scene, request);
  if (auto s = check_light_groups(*scene, animation, request, report.warnings); !s) return s.error();
  if (auto s = check_poses(*scene, animation, report.warnings); !s) return s.error();
  const auto meshes = check_mesh_size(request, *scene, animation);
  if (!meshes) return meshes.error();
  count_scene(*scene, meshes->fine, request.frame_count, report);
  const JobSize size = size_of_job(request, *scene, animation, meshes->fine.patches, meshes->coarse_patches);
  return PreparedJob{std::move(*scene), std::move(animation), size};
}

/// Fills the report's forecast, of the whole and of each stage.
MachinePace forecast_job(const PreparedJob& job, unsigned threads, api::JobReport& report) {
  const MachinePace pace = measure_pace(job.scene, job.animation, threads);
  report.forecast = forecast_of(job.size, pace);
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

/// As the layout says. Where it is `adaptive` the number of patches, of which only the most it can come to
/// was known, is then told to `report` and in `size`.
api::Result<Patches> cut_into_patches(const PreparedJob& job, const api::JobRequest& request,
                                      const Progress& progress, JobSize& size, api::JobReport& report) {
  if (request.lighting.patch_layout == api::PatchLayout::uniform)
    return mesh_into_patches(job.scene, request.lighting.patch_edge_m);
  const std::uint64_t budget = patch_budget(request, job.scene, job.animation);
  auto refined = refine_patches(job.scene, job.animation, request.lighting, budget, progress);
  if (!refined) return refined.error();
  size.patches = refined->patches.count();
  for (auto& [name, value] : report.counts)
    if (name == "patches") value = size.patches;
  report.counts.emplace_back("refinement_shadow_rays", static_cast<double>(refined->shadow_rays));
  return std::move(refined->patches);
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
  const auto job = prepare(request, input_folder, hooks.stop_requested, report);
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
  const auto published = publish_data(lit, *solved, *images, request.scene.up, artefacts_folder);
  if (!published) return published;
  api::fault_point("artefacts_published");
  checkpoints.clear();
  publishing.report(1);
  return published;
}

api::Status check_job(const api::JobRequest& request, const std::filesystem::path& input_folder,
                      unsigned threads, api::JobReport& report) {
  const auto job = prepare(
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
