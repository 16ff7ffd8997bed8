// write_sample FOLDER: the files that read_with_numpy.py checks.
#include <cstdio>

#include "engine/output/artefacts.h"
#include "tests/unit/output/sample.h"

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
        engine::write_manifest(folder, artefacts)})
    if (!status) {
      std::fprintf(stderr, "%s\n", status.error().message.c_str());
      return 1;
    }
}
