#include "engine/pipeline/publish.h"

#include <functional>

#include "engine/base/durable_file.h"
#include "engine/base/parallel.h"
#include "engine/image/node_rows.h"
#include "engine/image/render_images.h"
#include "engine/image/tone_map.h"
#include "engine/output/shading_mesh_npz.h"

namespace engine {
namespace {

api::Status make_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (!failed) return api::Done{};
  const auto fault = failed == std::errc::no_space_on_device ? api::Fault::disk_full : api::Fault::internal;
  return api::Error{fault, "cannot make the folder " + folder.string() + ": " + failed.message()};
}

const char* media_type_of(const std::filesystem::path& file) {
  if (file.extension() == ".jpg") return "image/jpeg";
  return file.extension() == ".exr" ? "image/x-exr" : "image/png";
}

constexpr std::string_view kImagesBegun = "images_begun";

/// Are the images in `folder` of this very job? Else they are removed, and from now on they are.
api::Status claim_images(const std::filesystem::path& folder, Checkpoints& checkpoints) {
  if (checkpoints.load(kImagesBegun)) return api::Done{};
  std::error_code failed;
  std::filesystem::remove_all(folder / "images", failed);
  if (failed) return file_error("remove", folder / "images", failed.value());
  // The removal before the claim: else a power cut in between would leave images of another job under it.
  if (auto synced = sync_folder(folder); !synced) return synced;
  // Without the claim (a full disk) the next attempt renders them all: no reason to fail.
  (void)checkpoints.save(kImagesBegun, {});
  return api::Done{};
}

/// Images that an earlier attempt has finished are progress.
void tell_of_finished(const std::vector<api::ImageOptions>& images, const std::filesystem::path& folder,
                      FrameIndex frame_count, StageClock& clock, api::JobReport& report) {
  std::size_t finished = 0;
  for (const api::ImageOptions& image : images)
    finished += count_finished_images(image, folder / "images" / image.camera, frame_count);
  if (finished == 0) return;
  const std::size_t all = images.size() * frame_count;
  clock.go_on_from(static_cast<double>(finished) / static_cast<double>(all),
                   "goes on with " + std::to_string(finished) + " of " + std::to_string(all) +
                       " images that an earlier attempt has finished");
  report.counts.emplace_back("resumed_images", static_cast<double>(finished));
}

}  // namespace

api::Result<PublishedImages> publish_images(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                                            const std::vector<api::ImageOptions>& images,
                                            const std::filesystem::path& folder, Checkpoints& checkpoints,
                                            StageClock& clock, api::JobReport& report) {
  const Progress& progress = clock.begin(api::Stage::images);
  if (const auto claimed = claim_images(folder, checkpoints); !claimed) return claimed.error();
  tell_of_finished(images, folder, lit.animation.frame_count, clock, report);
  PublishedImages published{{},
                            shown_surfaces(lit.scene, lit.patches, lit.animation, lit.static_rays),
                            auto_exposure_factor(lit.patches, lit.animation, radiosity_w_m2)};
  const auto share = [&](std::size_t k) {
    return static_cast<double>(k) / static_cast<double>(images.size());
  };
  for (std::size_t k = 0; k < images.size(); ++k) {
    const std::filesystem::path within = std::filesystem::path("images") / images[k].camera;
    if (const auto made = make_folder(folder / within); !made) return made.error();
    const auto files = render_images(
        lit.scene, lit.patches, lit.animation, lit.static_rays, radiosity_w_m2, images[k], folder / within,
        part_of(progress, share(k), share(k + 1)),
        {.auto_exposure = published.auto_exposure, .keep_finished = true, .surfaces = &published.surfaces});
    if (!files) return files.error();
    for (const std::string& file : *files)
      published.artefacts.push_back({(within / file).generic_string(), media_type_of(file)});
  }
  // Each camera's folder is synced with its files; its name stands in this one, whose own name is synced with
  // the files beside it.
  if (!images.empty())
    if (const auto synced = sync_folder(folder / "images"); !synced) return synced.error();
  return published;
}

api::Status publish_data(const LitScene& lit, const SolvedSequence& solved, const PublishedImages& images,
                         const api::JobRequest& request, const std::filesystem::path& folder) {
  std::vector<Artefact> artefacts;
  const Vec3 upward = request.scene.up == api::UpAxis::y ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const ShownAs shown_as{upward, images.auto_exposure};
  std::vector<std::function<api::Status()>>
      writers;  // side by side: one waits for the disk, another computes
  const auto publish_series = [&](const std::string& file, const PatchSeries& series) {
    artefacts.push_back({file, "application/x-npy"});
    writers.emplace_back([&folder, &series, file] { return write_radiosity_npy(folder / file, series); });
  };
  publish_series("radiosity.npy", solved.radiosity_w_m2);
  for (const NamedSeries& other : solved.others) publish_series(other.file, other.values_w_m2);
  artefacts.push_back({"patches.npz", "application/zip"});
  writers.emplace_back([&] {
    return write_patches_npz(folder / "patches.npz", lit.scene, lit.patches, lit.animation, shown_as);
  });
  artefacts.push_back({"shading_mesh.npz", "application/zip"});
  writers.emplace_back([&] {
    const NodeRows rows(images.surfaces.mesh, lit.patches, images.surfaces.uncovered);
    return write_shading_mesh_npz(
        folder / "shading_mesh.npz",
        {lit.scene, lit.patches, lit.animation, images.surfaces.mesh, &rows, request.images, shown_as,
         request.fps, request.scene.metres_per_unit, half_scale_of(images.auto_exposure)});
  });
  artefacts.push_back({"key_frames.json", "application/json"});
  writers.emplace_back(
      [&] { return write_file(folder / "key_frames.json", api::key_frame_report_json(solved.key_frames)); });

  std::vector<api::Status> written(writers.size(), api::Done{});
  parallel_for(writers.size(), [&](std::size_t k) { written[k] = writers[k](); });
  for (const api::Status& status : written)
    if (!status) return status;
  artefacts.insert(artefacts.end(), images.artefacts.begin(), images.artefacts.end());
  return write_manifest(folder, artefacts);
}

}  // namespace engine
