#include "engine/bench/bench_scene.h"

#include <algorithm>
#include <limits>

#include "engine/bench/bench_files.h"

namespace engine {
namespace {

/// Grows by points.
struct SceneBox {
  Vec3 low{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(),
           std::numeric_limits<float>::max()};
  Vec3 high = -low;

  void hold(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  double surface_m2() const {
    const Vec3 d = high - low;
    return d.x < 0 ? 0 : 2.0 * (double{d.x} * d.y + double{d.y} * d.z + double{d.z} * d.x);
  }
};

/// A patch of one side of an object: where in object space, of which material.
struct Probe {
  const char* material;
  Vec3 normal;
  Vec3 point;  ///< [m]
};

// As api/examples/room/make_scene.py puts them. Of the red cube's top the plane's shadow meets the corner
// that is farthest from the lamp; the wing's patch is half way out, where no fuselage is.
constexpr std::array<Probe, 3> kProbes{Probe{"red_cube", {0, 0, 1}, {-1.99f, 0.99f, 1}},
                                       Probe{"green_cube", {0, 1, 0}, {1.8f, -0.55f, 0.45f}},
                                       Probe{"plane", {0, 0, 1}, {0.035f, 0.385f, 0.014f}}};

Vec3 centre_of(const Patches& patches, PatchId patch) {
  const Facet& facet = patches.facets[patches.facet_of[patch]];
  const CellCorners corners = cell_corners(facet, patches.cell_of(patch));
  float u = 0, v = 0;
  for (std::uint32_t k = 0; k < corners.count; ++k) {
    u += corners.u[k] / static_cast<float>(corners.count);
    v += corners.v[k] / static_cast<float>(corners.count);
  }
  return facet.origin + u * facet.edge_u + v * facet.edge_v;
}

bool looks_along(Vec3 normal, Vec3 direction) {
  constexpr float kNearlyOne = 0.999f;
  return dot(normal, direction) > kNearlyOne;
}

PatchId nearest_patch(const BenchScene& scene, const Probe& probe) {
  PatchId nearest = kNoPatch;
  float least = std::numeric_limits<float>::max();
  for (PatchId patch = 0; patch < scene.patches.count(); ++patch) {
    const Facet& facet = scene.patches.facets[scene.patches.facet_of[patch]];
    if (scene.scene.materials[facet.material].name != probe.material) continue;
    if (scene.patches.is_back(patch) || !looks_along(facet.normal, probe.normal)) continue;
    const float away = length(centre_of(scene.patches, patch) - probe.point);
    if (away < least) nearest = patch;
    least = std::min(least, away);
  }
  return nearest;
}

}  // namespace

api::Result<BenchScene> load_bench_scene(const std::filesystem::path& input_folder) {
  const auto bytes = read_bench_file(input_folder / "animation.json");
  if (!bytes) return bytes.error();
  const auto request = api::parse_job_request(*bytes);
  if (!request) return request.error();
  auto scene = load_scene(input_folder, request->scene);
  if (!scene) return scene.error();
  Animation animation = animate(*scene, *request);
  auto patches = mesh_into_patches(*scene, request->lighting.patch_edge_m);
  if (!patches) return patches.error();
  return BenchScene{std::move(*scene), std::move(animation), std::move(*patches)};
}

PatchWeights patch_weights(const BenchScene& scene) {
  PatchWeights weights(scene.patches.count());
  for (PatchId patch = 0; patch < scene.patches.count(); ++patch) {
    const Facet& facet = scene.patches.facets[scene.patches.facet_of[patch]];
    weights[patch] = scene.animation.emission.ever_emits(facet.material) ? 0 : scene.patches.area_m2[patch];
  }
  return weights;
}

SceneNumbers scene_numbers(const BenchScene& scene) {
  SceneNumbers numbers;
  SceneBox all, motion;
  for (const Polygon& polygon : scene.scene.polygons) {
    const ObjectMotion& object = scene.animation.objects[polygon.object];
    const bool moves = !object.is_static(scene.animation.frame_count);
    (moves ? numbers.moving_polygons : numbers.static_polygons) += 1;
    for (const PoseSpan& span : object.spans)
      for (std::uint32_t k = 0; k < polygon.corner_count; ++k) {
        const Vec3 vertex = scene.scene.vertices[scene.scene.corners[polygon.first_corner + k]];
        const Vec3 point = transform_point(span.pose, vertex);
        all.hold(point);
        if (moves) motion.hold(point);
      }
  }
  numbers.box_m2 = all.surface_m2();
  numbers.motion_m2 = motion.surface_m2();
  return numbers;
}

api::Result<std::array<PatchId, 3>> find_probes(const BenchScene& scene) {
  std::array<PatchId, 3> found{};
  for (std::size_t k = 0; k < kProbes.size(); ++k) {
    found[k] = nearest_patch(scene, kProbes[k]);
    if (found[k] == kNoPatch)
      return api::Error{api::Fault::invalid_request, std::string("the room has no ") + kProbeNames[k]};
  }
  return found;
}

}  // namespace engine
