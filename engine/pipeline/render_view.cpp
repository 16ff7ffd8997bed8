#include "engine/pipeline/render_view.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "engine/image/render_images.h"
#include "engine/output/array_file.h"
#include "engine/output/artefacts.h"
#include "engine/patches/texture_reflectance.h"
#include "engine/pipeline/named_series.h"
#include "engine/pipeline/prepare_job.h"

namespace engine {
namespace {

/// The name of a camera that the view brings along; no job's, since names there begin otherwise.
constexpr const char* kOwnCamera = "-view";
constexpr std::uint32_t kBlock = 65'536;  ///< patches that are read at once

class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

api::Error of_another_job(const char* what) {
  return {api::Fault::wrong_state,
          std::string(what) + " is not that of this job and program; the job must be rendered again"};
}

/// The job with the view's camera and no other, since each costs a pose per frame.
api::JobRequest seen_by(const api::JobRequest& request, const api::ViewRequest& view) {
  api::JobRequest seen = request;
  seen.images = {view.image};
  if (view.own_camera) {
    seen.images[0].camera = kOwnCamera;
    seen.scene.cameras = {{kOwnCamera, *view.own_camera}};
  } else {
    std::erase_if(seen.scene.cameras, [&](const auto& camera) { return camera.first != view.image.camera; });
  }
  return seen;
}

/// What of patches.npz a view needs: the exposure of the job's pictures. And are they the same patches?
api::Result<std::optional<double>> check_patches(const std::filesystem::path& path, const Patches& patches) {
  const OpenFile file(path);
  const auto arrays = find_npz(file.get());
  if (!arrays) return arrays.error();
  const auto area = arrays->find("area_m2");
  if (area == arrays->end() || area->second.bytes != patches.area_m2.size() * sizeof(float))
    return of_another_job("patches.npz");
  std::vector<float> stored(patches.area_m2.size());
  if (auto read = read_at(file.get(), area->second.offset_bytes, stored.data(), area->second.bytes); !read)
    return read.error();
  if (stored != patches.area_m2) return of_another_job("patches.npz");
  const auto exposure = arrays->find("auto_exposure");
  if (exposure == arrays->end() || exposure->second.bytes != sizeof(double)) return std::optional<double>();
  double factor = 1;
  if (auto read = read_at(file.get(), exposure->second.offset_bytes, &factor, sizeof factor); !read)
    return read.error();
  return std::optional(factor);
}

/// Calls take(column, patch, value) for the frames of the view; column k is the frame frames[k].
template <class Take>
api::Status read_radiosity(const std::filesystem::path& path, std::uint32_t patch_count,
                           std::uint32_t frame_count, const std::vector<FrameIndex>& frames,
                           const Progress& progress, Take take) {
  const OpenFile file(path);
  const auto place = find_npy(file.get());
  if (!place) return place.error();
  if (place->dtype != "<f4" || place->shape != std::vector<std::uint64_t>{frame_count, patch_count, 3})
    return of_another_job(path.filename().c_str());
  std::vector<Rgb> block;
  for (std::uint32_t k = 0; k < frames.size(); ++k)
    for (std::uint32_t first = 0; first < patch_count; first += kBlock) {
      if (progress.stop_requested())
        return api::Error{api::Fault::stopped, "stopped while reading radiosity"};
      block.resize(std::min(kBlock, patch_count - first));
      const std::uint64_t at =
          place->offset_bytes + sizeof(Rgb) * (std::uint64_t{frames[k]} * patch_count + first);
      if (auto read = read_at(file.get(), at, block.data(), sizeof(Rgb) * block.size()); !read)
        return read.error();
      for (std::uint32_t p = 0; p < block.size(); ++p) take(k, first + p, block[p]);
    }
  return api::Done{};
}

Rgb rgb_of(const api::Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Rgb at_least(Rgb value, float least) {
  return max(value, Rgb{least, least, least});
}

/// Light is linear in what emits, so with the lights of group g `gain_g` times as bright
///
///     B + sum_g (gain_g - 1) B_g                                             [W/m^2]
///
/// Column k is the frame frames[k].
api::Result<PatchSeries> relit_radiosity(const api::ViewRequest& view, const std::filesystem::path& artefacts,
                                         std::uint32_t patch_count, std::uint32_t frame_count,
                                         const Progress& progress) {
  PatchSeries series(patch_count, static_cast<std::uint32_t>(view.frames.size()));
  const auto set = [&](std::uint32_t k, PatchId patch, Rgb value) { series.at(patch, k) = value; };
  if (auto read =
          read_radiosity(artefacts / "radiosity.npy", patch_count, frame_count, view.frames, progress, set);
      !read)
    return read.error();
  for (const auto& [group, gain] : view.light_gains) {
    const std::filesystem::path file = artefacts / file_of_group(group);
    std::error_code unknown;
    if (!std::filesystem::exists(file, unknown)) continue;  // nothing in it ever emits
    const Rgb more = rgb_of(gain) - Rgb{1, 1, 1};
    const auto add = [&](std::uint32_t k, PatchId patch, Rgb value) { series.at(patch, k) += more * value; };
    if (auto read = read_radiosity(file, patch_count, frame_count, view.frames, progress, add); !read)
      return read.error();
  }
  // A group that is off leaves the rounding of a difference.
  for (Rgb& value : series.values) value = at_least(value, 0);
  return series;
}

/// What a textured lamp sends out by itself is shown as it is, not through its texture.
void relight(const api::JobRequest& job, const api::ViewRequest& view, const Scene& scene,
             Emission& emission) {
  std::map<std::string, std::string> group_of;
  for (const auto& [group, names] : job.lighting.light_groups)
    for (const std::string& name : names) group_of.emplace(name, group);
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
    const auto named = group_of.find(scene.materials[m].name);
    const auto gain = view.light_gains.find(named == group_of.end() ? "other" : named->second);
    if (gain == view.light_gains.end()) continue;
    // A lamp that is off still is one: see Uncovered.
    const Rgb factor = at_least(rgb_of(gain->second), std::numeric_limits<float>::min());
    for (Rgb& exitance : emission.exitance_w_m2[m]) exitance = factor * exitance;
  }
}

std::vector<Artefact> artefacts_of(const std::vector<std::string>& files) {
  std::vector<Artefact> artefacts;
  for (const std::string& file : files) {
    const char* type = file.ends_with(".jpg")   ? "image/jpeg"
                       : file.ends_with(".exr") ? "image/x-exr"
                                                : "image/png";
    artefacts.push_back({file, type});
  }
  return artefacts;
}

}  // namespace

api::Status render_view(const api::JobRequest& request, const api::ViewRequest& view,
                        const ViewFolders& folders, const Progress& progress, api::JobReport& report) {
  const api::JobRequest seen = seen_by(request, view);
  auto job = prepare_job(seen, folders.input, progress.stop_requested, report);
  if (!job) return job.error();
  JobSize size = job->size;
  auto patches = cut_into_patches(*job, seen, part_of(progress, 0, 0.1), size, report);
  if (!patches) return patches.error();
  const auto exposure = check_patches(folders.artefacts / "patches.npz", *patches);
  if (!exposure) return exposure.error();
  patches->texture_reflectance = texture_reflectance(job->scene, job->animation, *patches);
  relight(request, view, job->scene, job->animation.emission);
  const auto radiosity =
      relit_radiosity(view, folders.artefacts, patches->count(), job->animation.frame_count, progress);
  if (!radiosity) return radiosity.error();
  const StaticRays static_rays(*patches, job->animation);
  const auto files = render_images(job->scene, *patches, job->animation, static_rays, *radiosity,
                                   seen.images[0], folders.view, part_of(progress, 0.1, 1),
                                   {.frames = view.frames, .auto_exposure = *exposure});
  if (!files) return files.error();
  return write_manifest(folders.view, artefacts_of(*files));
}

}  // namespace engine
