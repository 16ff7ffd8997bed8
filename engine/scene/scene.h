// The scene as the engine sees it: metres, indices, everything checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "api/result.h"
#include "api/scene_description.h"
#include "engine/base/rgb.h"
#include "engine/base/vec3.h"

namespace engine {

struct Polygon {
  std::uint32_t first_corner = 0;  ///< into Scene::corners
  std::uint32_t corner_count = 0;  ///< 3 .. 64; counter-clockwise seen from its front
  std::uint32_t object = 0;        ///< into Scene::objects
  std::uint32_t material = 0;      ///< into Scene::materials
  std::uint32_t obj_line = 0;      ///< 1-based line of scene.obj, for messages
};

struct Material {
  std::string name;
  Rgb reflectance;    ///< 0 <= rho < 1
  Rgb exitance_w_m2;  ///< of the front, where the animation does not key it  [W/m^2]
  bool both_sides = true;
};

/// One animated unit: an OBJ object or group that animation.json names, or what is left over.
struct SceneObject {
  std::string name;  ///< "" is everything that belongs to no named object
};

struct Scene {
  std::vector<Vec3> vertices;          ///< object space, before the pose  [m]
  std::vector<std::uint32_t> corners;  ///< vertex index of each polygon corner
  std::vector<Polygon> polygons;
  std::vector<SceneObject> objects;
  std::vector<Material> materials;
  std::vector<std::string> warnings;  ///< for people: ignored statements, map_Kd reduced to its mean, ...
};

/// Limits on what a scene may hold; beyond them load_scene answers out_of_resources.
struct SceneLimits {
  std::size_t vertices = 20'000'000;
  std::size_t polygons = 10'000'000;
  std::size_t objects = 100'000;
  std::size_t materials = 10'000;
  std::size_t line_bytes = 64u << 10;
  std::size_t texture_pixels = 64u << 20;
};

/// Reads `input_folder`/scene.obj and the MTL files and textures it names (by base name, from `input_folder`
/// only), and applies `description`'s materials and unit. Every violation carries file, line and column;
/// those that concern animation.json (an object the OBJ lacks) carry its JSON pointer. A scene that emits
/// nothing in any frame is a violation unless `description.allow_dark`.
api::Result<Scene> load_scene(const std::filesystem::path& input_folder,
                              const api::SceneDescription& description, const SceneLimits& limits = {});

}  // namespace engine
