#include "engine/pipeline/run_pipeline.h"

#include "engine/image/texture_file.h"
#include "engine/pipeline/check_poses.h"
#include "engine/pipeline/limits.h"
#include "engine/pipeline/publish.h"
#include "engine/pipeline/solve_sequence.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {
namespace {

/// What a job is about, checked and not yet cut into patches.
struct PreparedJob {
  Scene scene;
  Animation animation;
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
                                 api::JobReport& report) {
  auto scene = load_scene(input_folder, request.scene, {}, read_texture);
  if (!scene) return scene.error();
  report.warnings = scene->warnings;
  if (auto s = check_request_size(request, scene->objects.size()); !s) return s.error();
  Animation animation = animate(*scene, request);
  if (auto s = check_poses(*scene, animation, report.warnings); !s) return s.error();
  const auto count = check_mesh_size(request, *scene);
  if (!count) return count.error();
  count_scene(*scene, *count, request.frame_count, report);
  return PreparedJob{std::move(*scene), std::move(animation)};
}

}  // namespace

api::Status run_pipeline(const api::JobRequest& request, const std::filesystem::path& input_folder,
                         const std::filesystem::path& artefacts_folder, const RunHooks& hooks,
                         api::JobReport& report) {
  StageClock clock(hooks, report);
  clock.begin(api::Stage::scene);
  const auto job = prepare(request, input_folder, report);
  if (!job) return job.error();

  clock.begin(api::Stage::patches);
  const auto patches = mesh_into_patches(job->scene, request.lighting.patch_edge_m);
  if (!patches) return patches.error();
  const StaticRays static_rays(*patches, job->animation);
  const LitScene lit{job->scene, job->animation, *patches, static_rays};

  const auto solved = solve_sequence(lit, request.lighting, clock, report);
  if (!solved) return solved.error();

  const auto images = publish_images(lit, solved->radiosity_w_m2, request.images, artefacts_folder,
                                     clock.begin(api::Stage::images));
  if (!images) return images.error();
  const Progress& publishing = clock.begin(api::Stage::publish);
  const auto published =
      publish_data(lit, solved->radiosity_w_m2, solved->key_frames, *images, artefacts_folder);
  if (published) publishing.report(1);
  return published;
}

api::Status check_job(const api::JobRequest& request, const std::filesystem::path& input_folder,
                      api::JobReport& report) {
  const auto job = prepare(request, input_folder, report);
  return job ? api::Status(api::Done{}) : job.error();
}

}  // namespace engine
