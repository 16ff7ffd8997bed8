#include "engine/pipeline/run_pipeline.h"

#include "engine/image/texture_mean.h"
#include "engine/pipeline/limits.h"
#include "engine/pipeline/publish.h"
#include "engine/pipeline/solve_sequence.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {
namespace {

void count_scene(const Scene& scene, const Patches& patches, std::uint32_t frames, api::JobReport& report) {
  report.warnings = scene.warnings;
  report.counts.emplace_back("polygons", static_cast<double>(scene.polygons.size()));
  report.counts.emplace_back("patches", patches.count());
  report.counts.emplace_back("frames", frames);
}

}  // namespace

api::Status run_pipeline(const api::JobRequest& request, const std::filesystem::path& input_folder,
                         const std::filesystem::path& artefacts_folder, const RunHooks& hooks,
                         api::JobReport& report) {
  StageClock clock(hooks, report);
  clock.begin(api::Stage::scene);
  const auto scene = load_scene(input_folder, request.scene, {}, mean_reflectance_of_texture);
  if (!scene) return scene.error();
  const Animation animation = animate(*scene, request);

  clock.begin(api::Stage::patches);
  const auto patches = mesh_into_patches(*scene, request.lighting.patch_edge_m);
  if (!patches) return patches.error();
  count_scene(*scene, *patches, request.frame_count, report);
  if (auto s = check_size(*patches, request.frame_count); !s) return s;
  const StaticRays static_rays(*patches, animation);
  const LitScene lit{*scene, animation, *patches, static_rays};

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
  const auto scene = load_scene(input_folder, request.scene, {}, mean_reflectance_of_texture);
  if (!scene) return scene.error();
  const auto patches = mesh_into_patches(*scene, request.lighting.patch_edge_m);
  if (!patches) return patches.error();
  count_scene(*scene, *patches, request.frame_count, report);
  return check_size(*patches, request.frame_count);
}

}  // namespace engine
