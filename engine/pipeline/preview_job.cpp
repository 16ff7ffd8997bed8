#include "engine/pipeline/preview_job.h"

#include <string>

#include "engine/output/shading_mesh_npz.h"
#include "engine/patches/texture_reflectance.h"
#include "engine/pipeline/prepare_job.h"

namespace engine {
namespace {

/// Longer than any edge can be, so that no facet is cut.
constexpr double kWholeFacets_m = 1e9;

api::Error too_large(const std::string& what) {
  return {api::Fault::out_of_resources,
          "the scene is too large to be previewed: " + what,
          {{"scene.obj", "", 0, 0, "limit_exceeded", what}}};
}

/// Before any of it is made.
api::Status check_preview_size(const PreparedJob& job) {
  const auto count = count_patches(job.scene, kWholeFacets_m);
  if (!count) return count.error();
  if (count->patches > kPreviewPatchesMax)
    return too_large(std::to_string(count->patches) + " sides of facets; at most " +
                     std::to_string(kPreviewPatchesMax) + " are shown");
  const std::uint64_t bytes =
      walk_bytes(count->patches, job.scene.objects.size(), job.animation.cameras.size(),
                 job.animation.emission.sources.size(), job.animation.frame_count);
  if (bytes > kPreviewBytesMax)
    return too_large("its shapes and the poses of all frames take " + std::to_string(bytes >> 20) +
                     " MiB; at most " + std::to_string(kPreviewBytesMax >> 20) + " are sent");
  return api::Done{};
}

}  // namespace

api::Status preview_job(const api::JobRequest& request, const std::filesystem::path& input_folder,
                        const std::filesystem::path& file, api::JobReport& report) {
  const auto job = prepare_job(
      request, input_folder, [] { return false; }, report);
  if (!job) return job.error();
  if (auto fits = check_preview_size(*job); !fits) return fits;
  auto patches = mesh_into_patches(job->scene, kWholeFacets_m);
  if (!patches) return patches.error();
  patches->texture_reflectance = texture_reflectance(job->scene, job->animation, *patches);
  const ShadingMesh mesh = build_shading_mesh(*patches);
  const Vec3 up = request.scene.up == api::UpAxis::y ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return write_shading_mesh_npz(file, {job->scene,
                                       *patches,
                                       job->animation,
                                       mesh,
                                       nullptr,
                                       request.images,
                                       {up, 1},
                                       request.fps,
                                       request.scene.metres_per_unit,
                                       1});
}

}  // namespace engine
