// The scene as the engine sees it: metres, indices, everything checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
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

/// One animated unit: an OBJ object (`o`) or group (`g`) that animation.json names, or what is left over.
/// A face belongs to the first of its groups that animation.json names; where it names none of them, to its
/// object; else to "". So where both match, the group wins: it is the smaller unit.
struct SceneObject {
  std::string name;  ///< "" is everything that belongs to no named object
};

struct Scene {
  std::vector<Vec3> vertices;          ///< object space, before the pose  [m]
  std::vector<std::uint32_t> corners;  ///< vertex index of each polygon corner
  std::vector<Polygon> polygons;
  std::vector<SceneObject> objects;   ///< [0] is ""; then those of animation.json, by name
  std::vector<Material> materials;    ///< those that polygons use, in order of first use
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

/// Mean reflectance (linear RGB) of a texture of at most `pixels_max` pixels. engine/image/texture has the
/// one that reads PNG and JPEG files.
using TextureMean =
    std::function<api::Result<Rgb>(const std::filesystem::path& texture, std::size_t pixels_max)>;

/// Refuses every texture.
api::Result<Rgb> refuse_texture(const std::filesystem::path& texture, std::size_t pixels_max);

/// Reads `input_folder`/scene.obj and the MTL files and textures it names (by base name, without regard to
/// case, regular files in `input_folder` only), and applies `description`'s materials and unit. Polygons
/// without area are dropped with a warning. An MTL's Ke is radiance, so exitance = pi Ke; a texture (map_Kd)
/// replaces Kd by its mean, with a warning; faces before any usemtl get the material "" that reflects half.
///
/// Errors: invalid_request with every violation (up to kViolationsMax), each with file, 1-based line and
/// column (in bytes); those that concern animation.json carry its JSON pointer instead. Codes:
///   syntax, not_finite          a statement that cannot be read; a number that is NaN, infinite or too large
///   index_out_of_range          a corner names a vertex, normal or texture coordinate that is not there
///   too_few_corners, too_many_corners    a polygon has 3 .. 64 corners
///   no_faces                    nothing to light (file scene.obj, line 0)
///   missing_file                an MTL file or texture that is named but not in `input_folder`
///   unknown_material            usemtl names a material no MTL file has; or animation.json does
///   unknown_object              animation.json names an object or group that the OBJ lacks
///   out_of_range                |coordinate| > 1e7 units or metres, Kd < 0 or >= 1, Ke < 0. Kd of exactly 1
///                               is refused too: such light never dies
///   unreadable_texture          what `texture_mean` says
///   no_light                    no polygon emits in any frame, unless `description.allow_dark` (file
///                               animation.json, pointer "": that is where light is most easily added)
/// out_of_resources, code limit_exceeded: beyond `limits`. internal: the file system fails.
api::Result<Scene> load_scene(const std::filesystem::path& input_folder,
                              const api::SceneDescription& description, const SceneLimits& limits = {},
                              const TextureMean& texture_mean = refuse_texture);

}  // namespace engine
