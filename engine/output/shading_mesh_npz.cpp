#include "engine/output/shading_mesh_npz.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/durable_file.h"
#include "engine/image/camera.h"
#include "engine/image/tone_curve.h"
#include "engine/output/npz_arrays.h"
#include "engine/patches/texture_reflectance.h"

namespace engine {
namespace {

constexpr std::uint32_t kNoNode = 0xffffffffu;

void put(Vec3 v, float* out) {
  out[0] = v.x, out[1] = v.y, out[2] = v.z;
}

/// An array of the rows one after the other: of each of their parts what `take` says.
template <class Element, class Take>
api::Status write_rows(ZipStore& zip, std::string_view name, const NodeRows& rows, std::uint64_t parts,
                       Take take) {
  const std::array<std::uint64_t, 1> shape{parts};
  const std::string header = npy_header(ArrayWriter::dtype_of(Element{}), shape);
  if (auto begun = zip.begin(std::string(name) + ".npy", header.size() + parts * sizeof(Element)); !begun)
    return begun;
  if (auto written = zip.append(header); !written) return written;
  std::vector<PatchWeight> block;
  std::vector<Element> buffer;
  for (std::uint32_t node = 0; node < rows.node_count(); ++node) {
    rows.append(node, block);
    if (block.size() * sizeof(Element) < kArrayBufferBytes && node + 1 < rows.node_count()) continue;
    buffer.clear();
    for (const PatchWeight& part : block) buffer.push_back(take(part));
    block.clear();
    const std::string_view bytes(reinterpret_cast<const char*>(buffer.data()),
                                 buffer.size() * sizeof(Element));
    if (auto written = zip.append(bytes); !written) return written;
  }
  return api::Done{};
}

void add_nodes(ArrayWriter& arrays, const WalkScene& walk) {
  const ShadingMesh& mesh = walk.mesh;
  arrays.add<float>("node_position", {mesh.node_count, 3}, [&](std::uint64_t node, float* out) {
    put(position_of_node(mesh, walk.patches, static_cast<std::uint32_t>(node)), out);
  });
  std::uint64_t parts = 0;
  arrays.add<std::uint32_t>("row_first", {mesh.node_count + std::uint64_t{1}},
                            [&](std::uint64_t node, std::uint32_t* out) {
                              *out = static_cast<std::uint32_t>(parts);
                              if (walk.rows && node < mesh.node_count)
                                parts += walk.rows->size_of(static_cast<std::uint32_t>(node));
                            });
  if (!walk.rows) {
    arrays.add<std::uint32_t>("row_patch", {0}, [](std::uint64_t, std::uint32_t*) {});
    arrays.add<float>("row_weight", {0}, [](std::uint64_t, float*) {});
    return;
  }
  arrays.then([&](ZipStore& zip) {
    return write_rows<std::uint32_t>(zip, "row_patch", *walk.rows, parts,
                                     [](const PatchWeight& part) { return part.patch; });
  });
  arrays.then([&](ZipStore& zip) {
    return write_rows<float>(zip, "row_weight", *walk.rows, parts,
                             [](const PatchWeight& part) { return part.weight; });
  });
}

void add_patches(ArrayWriter& arrays, const WalkScene& walk) {
  const Patches& patches = walk.patches;
  const std::uint64_t count = patches.count();
  const auto facet_of = [&](std::uint64_t patch) -> const Facet& {
    return patches.facets[patches.facet_of[patch]];
  };
  arrays.add<std::uint32_t>("patch_nodes", {count, 4}, [&](std::uint64_t patch, std::uint32_t* out) {
    const PatchNodes nodes = nodes_of_patch(walk.mesh, patches, static_cast<PatchId>(patch));
    for (std::uint32_t k = 0; k < 4; ++k) out[k] = k < nodes.count ? nodes.node[k] : kNoNode;
  });
  arrays.add<std::uint32_t>("patch_object", {count},
                            [&](std::uint64_t patch, std::uint32_t* out) { *out = facet_of(patch).object; });
  arrays.add<std::uint32_t>("patch_material", {count}, [&](std::uint64_t patch, std::uint32_t* out) {
    *out = facet_of(patch).material;
  });
  arrays.add<std::uint32_t>("patch_facet", {count},
                            [&](std::uint64_t patch, std::uint32_t* out) { *out = patches.facet_of[patch]; });
  arrays.add<float>("patch_reflectance", {count, 3}, [&](std::uint64_t patch, float* out) {
    const Rgb rho = patch_reflectance(walk.scene, walk.animation, patches, static_cast<PatchId>(patch), 0);
    out[0] = rho.r, out[1] = rho.g, out[2] = rho.b;
  });
}

void add_names_and_motion(ArrayWriter& arrays, const WalkScene& walk) {
  arrays.add_names("object_names", names_of(walk.scene.objects));
  arrays.add_names("material_names", names_of(walk.scene.materials));
  arrays.add<std::uint8_t>("material_emits", {walk.scene.materials.size()},
                           [&](std::uint64_t material, std::uint8_t* out) {
                             *out = walk.animation.emission.ever_emits(static_cast<std::uint32_t>(material));
                           });
  add_motion<float>(arrays, walk.animation);
}

struct NamedCamera {
  std::string_view name;
  const std::vector<CameraPose>* poses;
};

void add_cameras(ArrayWriter& arrays, const WalkScene& walk) {
  const FrameIndex frames = walk.animation.frame_count;
  std::vector<NamedCamera> cameras;
  for (const auto& [name, poses] : walk.animation.cameras) cameras.push_back({name, &poses});
  arrays.add_names("camera_names", names_of(cameras));
  const auto add_vectors = [&](std::string_view name, auto vector_of) {
    arrays.add<float>(name, {cameras.size(), frames, 3}, [&](std::uint64_t c, float* out) {
      for (FrameIndex f = 0; f < frames; ++f)
        put(vector_of(pinhole_camera((*cameras[c].poses)[f], 1, 1)), out + std::size_t{3} * f);
    });
  };
  add_vectors("camera_position", [](const PinholeCamera& camera) { return camera.position; });
  add_vectors("camera_forward", [](const PinholeCamera& camera) { return camera.forward; });
  add_vectors("camera_up", [](const PinholeCamera& camera) { return normalized(camera.upward); });
  arrays.add<float>("camera_vertical_fov_deg", {cameras.size(), frames}, [&](std::uint64_t c, float* out) {
    for (const CameraPose& pose : *cameras[c].poses) *out++ = static_cast<float>(pose.vertical_fov_degrees);
  });
  arrays.add<std::uint32_t>("image_size", {cameras.size(), 2}, [&](std::uint64_t c, std::uint32_t* out) {
    const auto image = std::find_if(walk.images.begin(), walk.images.end(),
                                    [&](const auto& options) { return options.camera == cameras[c].name; });
    out[0] = image == walk.images.end() ? 0 : image->width;
    out[1] = image == walk.images.end() ? 0 : image->height;
  });
}

void add_lights(ArrayWriter& arrays, const Animation& animation) {
  const FrameIndex frames = animation.frame_count;
  const std::vector<SourceMotion>& lights = animation.emission.sources;
  arrays.add_names("light_names", names_of(lights));
  arrays.add<std::uint8_t>("light_kind", {lights.size()}, [&](std::uint64_t light, std::uint8_t* out) {
    *out = static_cast<std::uint8_t>(lights[light].type);
  });
  arrays.add<float>("light_position", {lights.size(), frames, 3}, [&](std::uint64_t light, float* out) {
    const bool has = lights[light].type != api::LightType::directional;
    for (FrameIndex f = 0; f < frames; ++f)
      put(has ? in_frame(lights[light].position, f) : Vec3{}, out + std::size_t{3} * f);
  });
  arrays.add<float>("light_direction", {lights.size(), frames, 3}, [&](std::uint64_t light, float* out) {
    const bool has = lights[light].type != api::LightType::point;
    for (FrameIndex f = 0; f < frames; ++f)
      put(has ? in_frame(lights[light].direction, f) : Vec3{}, out + std::size_t{3} * f);
  });
}

void add_numbers(ArrayWriter& arrays, const WalkScene& walk) {
  const Vec3 up = walk.shown_as.up;
  arrays.add<double>("up", {3}, [&](std::uint64_t k, double* out) {
    *out = k == 0 ? up.x : k == 1 ? up.y : up.z;
  });
  const auto add_number = [&](std::string_view name, double value) {
    arrays.add<double>(name, {1}, [&](std::uint64_t, double* out) { *out = value; });
  };
  add_number("fps", walk.fps);
  add_number("metres_per_unit", walk.metres_per_unit);
  add_number("auto_exposure", walk.shown_as.auto_exposure);
  add_number("half_scale", walk.half_scale);
}

}  // namespace

static_assert(static_cast<int>(api::LightType::point) == 0 && static_cast<int>(api::LightType::spot) == 1 &&
                  static_cast<int>(api::LightType::directional) == 2,
              "light_kind is written as the numbers that shading_mesh_npz.h says");

api::Status write_shading_mesh_npz(const std::filesystem::path& path, const WalkScene& walk) {
  auto file = DurableFile::create(path);
  if (!file) return file.error();
  ZipStore zip(*file);
  ArrayWriter arrays(zip);
  add_nodes(arrays, walk);
  add_patches(arrays, walk);
  add_names_and_motion(arrays, walk);
  add_cameras(arrays, walk);
  add_lights(arrays, walk.animation);
  add_numbers(arrays, walk);
  if (!arrays.status()) return arrays.status();
  if (auto done = zip.finish(); !done) return done;
  if (auto published = file->publish(); !published) return published;
  return sync_folder(path.parent_path());
}

double half_scale_of(double auto_exposure) {
  const double mean_w_m2 = kMiddleGrey * std::numbers::pi / auto_exposure;
  return std::exp2(std::clamp(std::round(std::log2(mean_w_m2)), -126.0, 126.0));
}

std::uint64_t walk_bytes(std::uint64_t patches, std::uint64_t objects, std::uint64_t cameras,
                         std::uint64_t lights, std::uint64_t frames) {
  constexpr std::uint64_t kPatch = 4 * 4 + 3 * 4 + 12, kNodes = 4 * (12 + 4);  // four nodes each at most
  return patches * (kPatch + kNodes) + frames * (objects * 49 + cameras * 40 + lights * 24);
}

}  // namespace engine
