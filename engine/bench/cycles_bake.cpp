#include "engine/bench/cycles_bake.h"

#include <cstdlib>
#include <numbers>
#include <sstream>

#include "api/json/json_text.h"
#include "engine/bench/bench_files.h"
#include "engine/bench/child_process.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

api::Json array_of(Vec3 v) {
  return {v.x, v.y, v.z};
}
api::Json array_of(Rgb c) {
  return {c.r, c.g, c.b};
}

/// None where the object is not there.
const Pose* pose_shown_in(const ObjectMotion& motion, FrameIndex frame) {
  for (const PoseSpan& span : motion.spans)
    if (span.first <= frame && frame <= span.last) return &span.pose;
  return nullptr;
}

api::Json materials_json(const BenchScene& scene, FrameIndex frame) {
  api::Json materials = api::Json::object();
  for (std::uint32_t k = 0; k < scene.scene.materials.size(); ++k) {
    const Material& material = scene.scene.materials[k];
    const auto per_pi = static_cast<float>(1 / std::numbers::pi);
    materials[material.name] = {
        {"reflectance", array_of(material_reflectance(scene.scene, scene.animation, k, frame))},
        {"radiance", array_of(per_pi * material.exitance_w_m2)}};
  }
  return materials;
}

api::Result<api::Json> facets_json(const BenchScene& scene, FrameIndex frame) {
  api::Json facets = api::Json::array();
  for (const Facet& facet : scene.patches.facets) {
    if (facet.is_triangle)
      return api::Error{api::Fault::invalid_request, "triangles are not baked for comparison"};
    const Pose* pose = pose_shown_in(scene.animation.objects[facet.object], frame);
    if (!pose) continue;
    facets.push_back({{"material", scene.scene.materials[facet.material].name},
                      {"origin", array_of(transform_point(*pose, facet.origin))},
                      {"u", array_of(transform_vector(*pose, facet.edge_u))},
                      {"v", array_of(transform_vector(*pose, facet.edge_v))},
                      {"parts", {facet.grid_u, facet.grid_v}}});
  }
  return facets;
}

api::Result<CyclesResult> read_result(const fs::path& path) {
  const auto bytes = read_bench_file(path);
  if (!bytes) return bytes.error();
  const auto json = api::parse_json(*bytes, path.filename().string());
  if (!json) return json.error();
  CyclesResult result{json->value("version", ""), json->value("points", std::uint64_t{0}), {}};
  for (const auto& bake : json->value("bakes", api::ParsedJson::array()))
    result.bakes.push_back(
        {bake.value("samples", 0), bake.value("seconds", std::vector<double>{}), bake.value("rmse", 0.0)});
  return result;
}

}  // namespace

std::optional<fs::path> find_blender() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code failed;
    const fs::path program = fs::path(folder) / "blender";
    if (fs::is_regular_file(program, failed)) return program;
  }
  return std::nullopt;
}

api::Result<CyclesResult> bake_with_cycles(const fs::path& blender, const BenchScene& scene, FrameIndex frame,
                                           const std::vector<int>& samples, const fs::path& folder) {
  auto facets = facets_json(scene, frame);
  if (!facets) return facets.error();
  const api::Json described{
      {"materials", materials_json(scene, frame)}, {"facets", std::move(*facets)}, {"samples", samples}};
  const fs::path script = fs::path(KEYLUME_PEERS) / "cycles_bake.py";
  const fs::path scene_file = folder / "scene.json", out = folder / "result.json";
  if (const auto s = write_bench_file(scene_file, api::json_text(described)); !s) return s.error();
  std::error_code ignored;
  fs::remove(out, ignored);
  const auto run = run_child({blender.string(), "-b", "--factory-startup", "--python-exit-code", "1",
                              "--python", script.string(), "--", scene_file.string(), out.string()},
                             folder / "log");
  if (!run) return run.error();
  return read_result(out);
}

}  // namespace engine
