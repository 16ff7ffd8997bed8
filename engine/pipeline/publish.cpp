#include "engine/pipeline/publish.h"

#include "engine/base/durable_file.h"
#include "engine/image/render_images.h"

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
  return file.extension() == ".exr" ? "image/x-exr" : "image/png";
}

}  // namespace

api::Result<std::vector<Artefact>> publish_images(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                                                  const std::vector<api::ImageOptions>& images,
                                                  const std::filesystem::path& folder,
                                                  const Progress& progress) {
  std::vector<Artefact> artefacts;
  const auto share = [&](std::size_t k) {
    return static_cast<double>(k) / static_cast<double>(images.size());
  };
  for (std::size_t k = 0; k < images.size(); ++k) {
    const std::filesystem::path within = std::filesystem::path("images") / images[k].camera;
    if (const auto made = make_folder(folder / within); !made) return made.error();
    const auto files = render_images(lit.patches, lit.animation, lit.static_rays, radiosity_w_m2, images[k],
                                     folder / within, part_of(progress, share(k), share(k + 1)));
    if (!files) return files.error();
    for (const std::string& file : *files)
      artefacts.push_back({(within / file).generic_string(), media_type_of(file)});
  }
  // Each camera's folder is synced with its files; its name stands in this one, whose own name is synced with
  // the files beside it.
  if (!images.empty())
    if (const auto synced = sync_folder(folder / "images"); !synced) return synced.error();
  return artefacts;
}

api::Status publish_data(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                         const api::KeyFrameReport& key_frames, const std::vector<Artefact>& images,
                         const std::filesystem::path& folder) {
  if (auto s = write_radiosity_npy(folder / "radiosity.npy", radiosity_w_m2); !s) return s;
  if (auto s = write_patches_npz(folder / "patches.npz", lit.scene, lit.patches, lit.animation); !s) return s;
  if (auto s = write_file(folder / "key_frames.json", api::key_frame_report_json(key_frames)); !s) return s;
  std::vector<Artefact> artefacts{{"radiosity.npy", "application/x-npy"},
                                  {"patches.npz", "application/zip"},
                                  {"key_frames.json", "application/json"}};
  artefacts.insert(artefacts.end(), images.begin(), images.end());
  return write_manifest(folder, artefacts);
}

}  // namespace engine
