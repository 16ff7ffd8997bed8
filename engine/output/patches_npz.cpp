#include <algorithm>

#include "engine/base/durable_file.h"
#include "engine/output/artefacts.h"
#include "engine/output/npz_arrays.h"

namespace engine {
namespace {

void fill_corners(const Patches& patches, PatchId patch, float* out) {
  const Facet& facet = patches.facets[patches.facet_of[patch]];
  const CellCorners corners = cell_corners(facet, patches.cell_of(patch));
  const bool back = patches.is_back(patch);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t turn = std::min(i, corners.count - 1);  // a triangle repeats its last corner
    const std::uint32_t c = back ? corners.count - 1 - turn : turn;
    const Vec3 p = facet.origin + corners.u[c] * facet.edge_u + corners.v[c] * facet.edge_v;
    out[3 * i] = p.x;
    out[3 * i + 1] = p.y;
    out[3 * i + 2] = p.z;
  }
}

void add_patches(ArrayWriter& arrays, const Patches& patches) {
  const std::uint64_t count = patches.count();
  const auto facet_of = [&](std::uint64_t patch) -> const Facet& {
    return patches.facets[patches.facet_of[patch]];
  };
  arrays.add<float>("corners", {count, 4, 3}, [&](std::uint64_t p, float* out) {
    fill_corners(patches, static_cast<PatchId>(p), out);
  });
  arrays.add<float>("normal", {count, 3}, [&](std::uint64_t p, float* out) {
    const bool back = patches.is_back(static_cast<PatchId>(p));
    const Vec3 n = back ? -facet_of(p).normal : facet_of(p).normal;
    out[0] = n.x, out[1] = n.y, out[2] = n.z;
  });
  arrays.add<float>("area_m2", {count}, [&](std::uint64_t p, float* out) { *out = patches.area_m2[p]; });
  arrays.add<std::uint32_t>("object", {count},
                            [&](std::uint64_t p, std::uint32_t* out) { *out = facet_of(p).object; });
  arrays.add<std::uint32_t>("material", {count},
                            [&](std::uint64_t p, std::uint32_t* out) { *out = facet_of(p).material; });
}

void add_shown_as(ArrayWriter& arrays, const ShownAs& shown_as) {
  const Vec3 up = shown_as.up;
  arrays.add<double>("up", {3}, [&](std::uint64_t k, double* out) {
    *out = k == 0 ? up.x : k == 1 ? up.y : up.z;
  });
  arrays.add<double>("auto_exposure", {1},
                     [&](std::uint64_t, double* out) { *out = shown_as.auto_exposure; });
}

}  // namespace

api::Status write_patches_npz(const std::filesystem::path& path, const Scene& scene, const Patches& patches,
                              const Animation& animation, const ShownAs& shown_as) {
  auto file = DurableFile::create(path);
  if (!file) return file.error();
  ZipStore zip(*file);
  ArrayWriter arrays(zip);
  add_patches(arrays, patches);
  add_motion<double>(arrays, animation);
  arrays.add_names("object_names", names_of(scene.objects));
  arrays.add_names("material_names", names_of(scene.materials));
  add_shown_as(arrays, shown_as);
  if (!arrays.status()) return arrays.status();
  if (auto done = zip.finish(); !done) return done;
  if (auto published = file->publish(); !published) return published;
  return sync_folder(path.parent_path());
}

}  // namespace engine
