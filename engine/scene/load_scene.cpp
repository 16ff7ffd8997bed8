#include <algorithm>
#include <set>
#include <string_view>

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
using Objects = std::map<std::string, api::ObjectAnimation>;

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

/// Of objects or lights, in `section` of animation.json: is what carries them animated?
template <class Carried>
void check_parents(const std::string& section, const std::map<std::string, Carried>& all_carried,
                   const Objects& objects, const std::vector<std::string>& animated, Violations& all) {
  for (const auto& [name, carried] : all_carried) {
    const bool known = carried.parent.empty() || objects.contains(carried.parent);
    if (known || all.size() >= api::kViolationsMax) continue;
    all.push_back({kAnimation, "/" + section + "/" + api::pointer_step(name) + "/parent", 0, 0,
                   "unknown_parent",
                   "'objects' has no " + excerpt(carried.parent) + did_you_mean(carried.parent, animated)});
  }
}

/// One that carries others needs no faces.
void warn_about_idle_objects(const api::SceneDescription& description, Scene& scene) {
  std::vector<bool> used(scene.objects.size(), false);
  for (const Polygon& polygon : scene.polygons) used[polygon.object] = true;
  std::set<std::string_view> parents;
  for (const auto& [name, object] : description.objects) parents.insert(object.parent);
  for (const auto& [name, light] : description.lights) parents.insert(light.parent);
  for (std::size_t i = 1; i < used.size(); ++i)
    if (!used[i] && !parents.contains(scene.objects[i].name))
      scene.warnings.push_back(std::string(kAnimation) + ": object " + excerpt(scene.objects[i].name) +
                               " has no faces of its own (a group that is animated too takes them)");
}

bool is_ever_positive(const api::Track<api::Vec3>& track) {
  return std::any_of(track.keys.begin(), track.keys.end(), [](const auto& key) {
    return key.value[0] > 0 || key.value[1] > 0 || key.value[2] > 0;
  });
}

bool emits(const Material& material, const api::SceneDescription& description) {
  const auto settings = description.materials.find(material.name);
  if (settings != description.materials.end() && is_ever_positive(settings->second.exitance_w_m2))
    return true;
  return max_channel(material.exitance_w_m2) > 0;
}

void check_light(const Scene& scene, const api::SceneDescription& description, Violations& all) {
  if (description.allow_dark) return;
  std::vector<bool> used(scene.materials.size(), false);
  for (const Polygon& polygon : scene.polygons) used[polygon.material] = true;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] && emits(scene.materials[i], description)) return;
  for (const auto& [name, light] : description.lights)
    if (is_ever_positive(light.intensity)) return;
  all.push_back({kAnimation, "", 0, 0, "no_light",
                 "nothing emits light in any frame: give a material 'exitance_w_m2' in animation.json or Ke "
                 "in its MTL file, or add 'lights', or set 'allow_dark'"});
}

api::Error stopped() {
  return {api::Fault::stopped, "stopped while reading the scene"};
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
                              const TextureReader& texture_reader,
                              const std::function<bool()>& stop_requested) {
  const std::vector<std::string> animated = animated_names(description);
  if (animated.size() > limits.objects)
    return api::Error{api::Fault::out_of_resources,
                      "animation.json animates more objects than this service allows",
                      {{kAnimation, "/objects", 0, 0, "limit_exceeded",
                        "more than " + std::to_string(limits.objects) + " objects"}}};
  Violations all;
  FileViolations in_obj{kObj, all};
  auto obj = read_obj_file(input_folder / kObj, animated, description.metres_per_unit, limits, in_obj,
                           stop_requested);
  if (!obj) return obj.error();
  if (in_obj.full()) return refused(std::move(all));
  if (stop_requested()) return stopped();

  Scene scene;
  obj->ignored.report(kObj, scene.warnings);
  if (obj->face_statements == 0)
    in_obj.add(0, 0, "no_faces", "there is no polygon ('f') in the file: nothing to light");
  check_objects(*obj, animated, all);
  check_parents("objects", description.objects, description.objects, animated, all);
  check_parents("lights", description.lights, description.objects, animated, all);
  auto materials = resolve_materials(*obj, list_input_files(input_folder), description, limits,
                                     texture_reader, all, scene.warnings);
  if (!materials) return materials.error();
  if (stop_requested()) return stopped();
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
  warn_about_idle_objects(description, scene);
  return scene;
}

}  // namespace engine
