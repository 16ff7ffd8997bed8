// write_sample FOLDER: the files that read_with_numpy.py checks.
#include <cstdio>

#include "engine/image/node_rows.h"
#include "engine/output/artefacts.h"
#include "engine/output/shading_mesh_npz.h"
#include "tests/unit/output/sample.h"

namespace {

/// The sample seen by two cameras, the second of which flies along x and has pictures, and lit by a spot.
api::Status write_walk(const std::filesystem::path& path, const engine::Patches& patches) {
  const engine::Scene scene = tests::sample_scene();
  engine::Animation animation = tests::sample_animation();
  const engine::CameraPose above{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
  animation.cameras["above"] = {above, above, above};
  for (float x : {0.0f, 1.0f, 2.0f})
    animation.cameras["side"].push_back({{x, -4, 1}, {x, 0, 1}, {0, 0, 1}, 50});
  engine::SourceMotion spot;
  spot.name = "lamp";
  spot.type = api::LightType::spot;
  spot.position = {{1, 2, 3}};
  spot.direction = {{0, 0, -1}};
  spot.intensity = {{1, 1, 1}};
  animation.emission.sources = {spot};
  animation.emission.exitance_w_m2[1] = {{0, 0, 0}, {2, 2, 2}, {0, 0, 0}};
  const engine::ShadingMesh mesh = engine::build_shading_mesh(patches);
  const engine::NodeRows rows(mesh, patches, {});
  api::ImageOptions image;
  image.camera = "side";
  return engine::write_shading_mesh_npz(
      path, {scene, patches, animation, mesh, &rows, {image}, {{0, 0, 1}, 0.25}, 12.5, 0.5, 2});
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return 64;
  const std::filesystem::path folder = arguments[1];
  const auto patches = engine::mesh_into_patches(tests::sample_scene(), 0.5);
  if (!patches) return 1;
  const auto radiosity = tests::numbered_series(patches->count(), 3);
  const engine::Artefact artefacts[] = {{"radiosity.npy", "application/x-npy"},
                                        {"patches.npz", "application/zip"}};
  for (const auto& status :
       {engine::write_radiosity_npy(folder / "radiosity.npy", radiosity),
        engine::write_patches_npz(folder / "patches.npz", tests::sample_scene(), *patches,
                                  tests::sample_animation(), {{0, 0, 1}, 0.25}),
        write_walk(folder / "shading_mesh.npz", *patches), engine::write_manifest(folder, artefacts)})
    if (!status) {
      std::fprintf(stderr, "%s\n", status.error().message.c_str());
      return 1;
    }
}
