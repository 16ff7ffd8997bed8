#include "api/pointer_step.h"
#include "api/refusal_text.h"
#include "engine/scene/clean_polygons.h"
#include "engine/scene/corner_attributes.h"
#include "engine/scene/input_files.h"
#include "engine/scene/names.h"
#include "engine/scene/obj_file.h"
#include "engine/scene/resolve_materials.h"
#include "engine/scene/scene.h"

namespace engine {
namespace {

constexpr const char* kObj = "scene.obj";
constexpr const char* kAnimation = "animation.json";

using Violations = std::vector<api::Violation>;

/// [0] is "", then the objects of animation.json in the order of the map.
std::vector<std::string> animated_names(const api::SceneDescription& description) {
  std::vector<std::string> names{""};
  for (const auto& [name, motion] : description.objects)
    if (!name.empty()) names.push_back(name);
  return names;
}

void check_objects(const ObjFile& obj, const std::vector<std::string>& animated, Violations& all) {
  for (std::size_t i = 1; i < animated.size() && all.size() < api::kViolationsMax; ++i) {
    if (obj.animated_seen[i]) continue;
    all.push_back({kAnimation, "/objects/" + api::pointer_step(animated[i]), 0, 0, "unknown_object",
                   "scene.obj has no object or group " + excerpt(animated[i]) +
                       did_you_mean(animated[i], obj.o_and_g_names)});
  }
}

void warn_about_idle_objects(Scene& scene) {
  std::vector<bool> used(scene.objects.size(), false);
  for (const Polygon& polygon : scene.polygons) used[polygon.object] = true;
  for (std::size_t i = 1; i < used.size(); ++i)
    if (!used[i])
      scene.warnings.push_back(std::string(kAnimation) + ": object " + excerpt(scene.objects[i].name) +
                               " has no faces of its own (a group that is animated too takes them)");
}

bool emits(const Material& material, const api::SceneDescription& description) {
  const auto settings = description.materials.find(material.name);
  if (settings != description.materials.end())
    for (const auto& key : settings->second.exitance_w_m2.keys)
      if (key.value[0] > 0 || key.value[1] > 0 || key.value[2] > 0) return true;
  return max_channel(material.exitance_w_m2) > 0;
}

void check_light(const Scene& scene, const api::SceneDescription& description, Violations& all) {
  if (description.allow_dark) return;
  std::vector<bool> used(scene.materials.size(), false);
  for (const Polygon& polygon : scene.polygons) used[polygon.material] = true;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] && emits(scene.materials[i], description)) return;
  all.push_back(
      {kAnimation, "", 0, 0, "no_light",
       "nothing emits light in any frame: give a material 'exitance_w_m2' in animation.json or Ke in its "
       "MTL file, or set 'allow_dark'"});
}

api::Error refused(Violations all) {
  std::string message = api::refusal_text("the scene", all.size());
  return {api::Fault::invalid_request, std::move(message), std::move(all)};
}

}  // namespace

api::Result<Texture> refuse_texture(const std::filesystem::path&, std::size_t) {
  return api::Error{api::Fault::invalid_request, "textures are not read here"};
}

api::Result<Scene> load_scene(const std::filesystem::path& input_folder,
                              const api::SceneDescription& description, const SceneLimits& limits,
                              const TextureReader& texture_reader) {
  const std::vector<std::string> animated = animated_names(description);
  if (animated.size() > limits.objects)
    return api::Error{api::Fault::out_of_resources,
                      "animation.json animates more objects than this service allows",
                      {{kAnimation, "/objects", 0, 0, "limit_exceeded",
                        "more than " + std::to_string(limits.objects) + " objects"}}};
  Violations all;
  FileViolations in_obj{kObj, all};
  auto obj = read_obj_file(input_folder / kObj, animated, description.metres_per_unit, limits, in_obj);
  if (!obj) return obj.error();
  if (in_obj.full()) return refused(std::move(all));

  Scene scene;
  obj->ignored.report(kObj, scene.warnings);
  if (obj->face_statements == 0)
    in_obj.add(0, 0, "no_faces", "there is no polygon ('f') in the file: nothing to light");
  check_objects(*obj, animated, all);
  auto materials = resolve_materials(*obj, list_input_files(input_folder), description, limits,
                                     texture_reader, all, scene.warnings);
  if (!materials) return materials.error();
  if (!all.empty()) return refused(std::move(all));

  scene.vertices = std::move(obj->vertices);
  scene.corners = std::move(obj->corners);
  scene.polygons = std::move(obj->polygons);
  scene.corner_uvs = std::move(obj->corner_uvs);
  scene.corner_normals = std::move(obj->corner_normals);
  scene.uvs = std::move(obj->uvs);
  scene.normals = std::move(obj->normals);
  scene.materials = std::move(materials->materials);
  scene.textures = std::move(materials->textures);
  for (const std::string& name : animated) scene.objects.push_back({name});
  settle_corner_attributes(scene);
  clean_polygons(scene);
  if (scene.polygons.empty())
    in_obj.add(0, 0, "no_faces", "no polygon of the file has an area: nothing to light");
  else
    check_light(scene, description, all);
  if (!all.empty()) return refused(std::move(all));
  warn_about_idle_objects(scene);
  return scene;
}

}  // namespace engine
