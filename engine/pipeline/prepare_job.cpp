#include "engine/pipeline/prepare_job.h"

#include "engine/animation/check_light_groups.h"
#include "engine/image/texture_file.h"
#include "engine/pipeline/check_poses.h"
#include "engine/pipeline/limits.h"
#include "engine/pipeline/refine_patches.h"

namespace engine {
namespace {

void count_scene(const Scene& scene, const PatchCount& count, std::uint32_t frames, api::JobReport& report) {
  if (count.dropped_facets > 0)
    report.warnings.push_back(std::to_string(count.dropped_facets) +
                              (count.dropped_facets == 1 ? " sliver" : " slivers") +
                              " of polygons without an area left out");
  report.counts.emplace_back("polygons", static_cast<double>(scene.polygons.size()));
  report.counts.emplace_back("patches", static_cast<double>(count.patches));
  report.counts.emplace_back("frames", frames);
}

}  // namespace

api::Result<PreparedJob> prepare_job(const api::JobRequest& request,
                                     const std::filesystem::path& input_folder,
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

}  // namespace engine
