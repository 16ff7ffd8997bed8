#include "engine/pipeline/limits.h"

#include <algorithm>
#include <cstdio>

#include "engine/base/rgb.h"
#include "engine/estimate/estimate.h"
#include "engine/pipeline/light_indirectly.h"

namespace engine {
namespace {

/// Per patch 72 bytes, per pose 97, per name 4 x 256 (110,000 of them at most).
static_assert(std::uint64_t{72} * kPatchesMax + 97 * kPosesMax + std::uint64_t{1024} * 110'000 <
                  std::uint64_t{4} << 30,
              "patches.npz holds 4 GiB");

std::string mebibytes(std::uint64_t bytes) {
  return std::to_string(bytes >> 20) + " MiB";
}

api::Violation too_much(std::string pointer, std::string detail) {
  return {"animation.json", std::move(pointer), 0, 0, "limit_exceeded", std::move(detail)};
}

/// The first of the violations is the message as well: it is what many clients show alone.
api::Status refuse_if_any(std::vector<api::Violation> violations) {
  if (violations.empty()) return api::Done{};
  std::string message = violations.front().detail;
  return api::Error{api::Fault::out_of_resources, std::move(message), std::move(violations)};
}

void check_images(const api::JobRequest& request, std::vector<api::Violation>& violations) {
  double samples = 0, most = 0;
  std::size_t largest = 0;
  for (std::size_t k = 0; k < request.images.size(); ++k) {
    const api::ImageOptions& image = request.images[k];
    const double of_image =
        static_cast<double>(request.frame_count) * image.width * image.height * image.samples_per_pixel;
    samples += of_image;
    if (of_image > most) largest = k;
    most = std::max(most, of_image);
  }
  if (samples <= kImageSamplesMax) return;
  violations.push_back(too_much("/images/" + std::to_string(largest),
                                "the images take " + rounded(samples) + " samples in all frames, more than " +
                                    rounded(kImageSamplesMax) +
                                    "; choose a smaller width, height or samples_per_pixel"));
}

/// Of one mesh, whose edge is the field `field` of the lighting and of which a run holds `series`.
api::Status check_series(std::uint64_t patches, std::uint32_t frames, std::uint64_t series,
                         const std::string& field) {
  const std::string pointer = "/lighting/" + field;
  if (patches > kPatchesMax)
    return refuse_if_any({too_much(pointer, "the scene cuts into " + rounded(static_cast<double>(patches)) +
                                                " patches, more than " + std::to_string(kPatchesMax) +
                                                "; choose a larger " + field)});
  const std::uint64_t bytes = patches * frames * sizeof(Rgb) * series;
  if (bytes <= kRunBytesMax) return api::Done{};
  return refuse_if_any(
      {too_much(pointer, std::to_string(patches) + " patches in " + std::to_string(frames) + " frames take " +
                             mebibytes(bytes) + ", more than " + mebibytes(kRunBytesMax) +
                             "; choose a larger " + field + " or fewer frames")});
}

/// As many as a run can hold, and no more than are asked for.
std::uint64_t budget(const api::JobRequest& request, std::uint64_t groups) {
  const std::uint64_t held =
      kRunBytesMax / (series_of_run(request.lighting, groups) * sizeof(Rgb) * request.frame_count);
  return std::min({request.lighting.patch_count_max, std::uint64_t{kPatchesMax}, held});
}

/// Counts the patches of the lighting.
api::Result<PatchCount> check_fine_mesh(const api::JobRequest& request, const Scene& scene,
                                        std::uint64_t groups) {
  const api::LightingOptions& lighting = request.lighting;
  auto count = count_patches(scene, MeshOptions{lighting.patch_edge_m, lighting.patch_layout});
  if (!count) return count.error();
  const bool adaptive = lighting.patch_layout == api::PatchLayout::adaptive;
  if (adaptive && count->patches > lighting.patch_count_max)
    return refuse_if_any({too_much("/lighting/patch_count_max",
                                   "the scene cuts into " + rounded(static_cast<double>(count->patches)) +
                                       " patches at the coarsest, more than patch_count_max; choose a larger "
                                       "patch_count_max or patch_edge_m")})
        .error();
  if (auto s =
          check_series(count->patches, request.frame_count, series_of_run(lighting, groups), "patch_edge_m");
      !s)
    return s.error();
  if (adaptive) count->patches = std::max(count->patches, std::min(count->finest, budget(request, groups)));
  return count;
}

}  // namespace

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::uint64_t series_of_run(const api::LightingOptions& lighting, std::uint64_t groups) {
  const bool total = lighting.interpolated == api::Interpolated::total;
  return 4 * groups + 6 + (total ? 3 : 2) * lighting.light_groups.size();
}

std::uint64_t series_of_estimate(const api::LightingOptions& lighting, std::uint64_t groups) {
  const bool total = lighting.interpolated == api::Interpolated::total;
  const std::uint64_t compared = lighting.mode != api::LightingMode::standard ? 0 : total ? 1 : groups;
  return 1 + groups + ReplicateSeries::kOfGroup * compared + std::max<std::uint64_t>(6, compared + 1);
}

std::uint64_t patch_budget(const api::JobRequest& request, const Scene& scene, const Animation& animation) {
  return budget(request, solved_groups(scene, animation, request.lighting).size());
}

api::Status check_request_size(const api::JobRequest& request, std::size_t object_count) {
  std::vector<api::Violation> violations;
  const std::uint64_t poses =
      std::uint64_t{object_count + request.scene.cameras.size()} * request.frame_count;
  if (poses > kPosesMax)
    violations.push_back(too_much("/objects", std::to_string(object_count) + " objects in " +
                                                  std::to_string(request.frame_count) +
                                                  " frames take more than " + std::to_string(kPosesMax) +
                                                  " poses; name fewer objects or choose fewer frames"));
  check_images(request, violations);
  return refuse_if_any(std::move(violations));
}

api::Result<MeshSizes> check_mesh_size(const api::JobRequest& request, const Scene& scene,
                                       const Animation& animation) {
  const api::LightingOptions& lighting = request.lighting;
  const std::uint64_t groups = solved_groups(scene, animation, lighting).size();
  const auto count = check_fine_mesh(request, scene, groups);
  if (!count) return count.error();
  const bool has_estimate =
      lighting.mode != api::LightingMode::reference && lighting.mode != api::LightingMode::frame_by_frame;
  if (!has_estimate) return MeshSizes{*count, 0};
  const auto coarse = count_patches(scene, lighting.estimate_patch_edge_m);
  if (!coarse) return coarse.error();
  if (auto s = check_series(coarse->patches, request.frame_count, series_of_estimate(lighting, groups),
                            "estimate_patch_edge_m");
      !s)
    return s.error();
  return MeshSizes{*count, coarse->patches};
}

}  // namespace engine
