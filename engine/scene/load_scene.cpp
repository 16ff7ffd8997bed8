#include <algorithm>
#include <set>
#include <string_view>

#include "api/pointer_step.h"
#include "engine/scene/clean_polygons.h"
#include "engine/scene/corner_attributes.h"
#include "engine/scene/found.h"
#include "engine/scene/input_files.h"
#include "engine/scene/names.h"
#include "engine/scene/obj_file.h"
#include "engine/scene/refuse_scene.h"
#include "engine/scene/resolve_materials.h"
#include "engine/scene/scene.h"

namespace engine {
namespace {

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
    all.push_back({kAnimationFile, "/objects/" + api::pointer_step(animated[i]), 0, 0, "unknown_object",
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
    all.push_back({kAnimationFile, "/" + section + "/" + api::pointer_step(name) + "/parent", 0, 0,
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
      scene.warnings.push_back(std::string(kAnimationFile) + ": object " + excerpt(scene.objects[i].name) +
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
  all.push_back({kAnimationFile, "", 0, 0, "no_light",
                 "nothing emits light in any frame: give a material 'exitance_w_m2' in animation.json or Ke "
                 "in its MTL file, or add 'lights', or set 'allow_dark'"});
}

api::Error stopped() {
  return {api::Fault::stopped, "stopped while reading the scene"};
}

/// Does one of the violations concern the value at `pointer`, or one that holds it?
bool concerns(const Violations& violations, const std::string& pointer) {
  return std::any_of(violations.begin(), violations.end(), [&](const api::Violation& v) {
    return v.pointer == pointer || v.pointer.starts_with(pointer + '/') ||
           pointer.starts_with(v.pointer + '/');
  });
}

/// Is what animation.json says of the material known, for all that is wrong with that file?
bool knows_settings(const api::ReadRequest& read, const std::string& material) {
  if (!read.is_document || read.violations.size() >= api::kViolationsMax) return false;
  return !concerns(read.violations, "/materials/" + api::pointer_step(material));
}

}  // namespace

api::Result<Texture> refuse_texture(const std::filesystem::path&, std::size_t) {
  return api::Error{api::Fault::invalid_request, "textures are not read here"};
}

namespace {

/// What load_scene is given.
struct Input {
  const std::filesystem::path& folder;
  const api::SceneDescription& description;
  const api::ReadRequest* refused;  ///< animation.json where it is wrong, else null
  const SceneLimits& limits;
  const TextureReader& texture_reader;
  const std::function<bool()>& stop_requested;
};

/// Reads the OBJ and checks the names that animation.json has in it.
api::Result<ObjFile> read_obj(const Input& input, const std::vector<std::string>& animated, Found& found,
                              std::vector<std::string>& warnings) {
  const api::SceneDescription& description = input.description;
  FileViolations in_obj{kObjFile, found.obj};
  auto obj = read_obj_file(input.folder / kObjFile, animated, description.metres_per_unit, input.limits,
                           in_obj, input.stop_requested);
  if (!obj) return obj;
  if (input.stop_requested()) return stopped();
  if (in_obj.full()) return obj;  // its end was not reached: nothing is known to be missing
  obj->ignored.report(kObjFile, warnings);
  if (obj->face_statements == 0)
    in_obj.add(0, 0, "no_faces", "there is no polygon ('f') in the file: nothing to light");
  check_objects(*obj, animated, found.names);
  if (!input.refused) {  // else that was checked with the rest of animation.json
    check_parents("objects", description.objects, description.objects, animated, found.names);
    check_parents("lights", description.lights, description.objects, animated, found.names);
  }
  return obj;
}

/// Reads what there is into `scene`, and adds to `found` what is wrong with it. An error: it ended early.
api::Status read(const Input& input, Scene& scene, Found& found) {
  const std::vector<std::string> animated = animated_names(input.description);
  if (animated.size() > input.limits.objects)
    return api::Error{api::Fault::out_of_resources,
                      "animation.json animates more objects than this service allows",
                      {{kAnimationFile, "/objects", 0, 0, "limit_exceeded",
                        "more than " + std::to_string(input.limits.objects) + " objects"}}};
  auto obj = read_obj(input, animated, found, scene.warnings);
  if (!obj) return obj.error();
  KnownParts known{.all_uses = found.obj.size() < api::kViolationsMax};
  if (input.refused)
    known.settings = [&](const std::string& material) { return knows_settings(*input.refused, material); };
  auto materials = resolve_materials(*obj, list_input_files(input.folder), input.description, known,
                                     input.limits, input.texture_reader, found.materials, scene.warnings);
  if (!materials) return materials.error();
  if (input.stop_requested()) return stopped();

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
  return api::Done{};
}

}  // namespace

api::Result<Scene> load_scene(const std::filesystem::path& input_folder,
                              const api::SceneDescription& description, const SceneLimits& limits,
                              const TextureReader& texture_reader,
                              const std::function<bool()>& stop_requested) {
  Scene scene;
  Found found;
  const Input input{input_folder, description, nullptr, limits, texture_reader, stop_requested};
  if (const api::Status whole = read(input, scene, found); !whole) return whole.error();
  if (!found.is_empty()) return refused(found);
  settle_corner_attributes(scene);
  clean_polygons(scene);
  if (scene.polygons.empty())
    FileViolations{kObjFile, found.obj}.add(0, 0, "no_faces",
                                            "no polygon of the file has an area: nothing to light");
  else
    check_light(scene, description, found.names);
  if (!found.is_empty()) return refused(found);
  warn_about_idle_objects(description, scene);
  return scene;
}

api::Error refuse_scene(const std::filesystem::path& input_folder, const api::ReadRequest& read_request,
                        const SceneLimits& limits, const TextureReader& texture_reader,
                        const std::function<bool()>& stop_requested) {
  Scene scene;
  Found found{read_request.violations, {}, {}, {}};
  const Input input{input_folder,  read_request.request.scene, &read_request, limits, texture_reader,
                    stop_requested};
  const api::Status whole = read(input, scene, found);
  if (!whole && whole.error().fault == api::Fault::stopped) return whole.error();
  // Where it ended early (the OBJ is missing, or too large), that is one more place to mend.
  if (!whole) {
    const Violations& why = whole.error().violations;
    found.obj.insert(found.obj.end(), why.begin(), why.end());
  }
  return refused(found);
}

}  // namespace engine
