// The scene as the engine sees it: metres, indices, everything checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "api/result.h"
#include "api/scene_description.h"
#include "engine/base/rgb.h"
#include "engine/base/vec3.h"
#include "engine/scene/texture.h"

namespace engine {

/// Of a corner: it has no such thing.
inline constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

struct Polygon {
  std::uint32_t first_corner = 0;  ///< into Scene::corners
  std::uint32_t corner_count = 0;  ///< 3 .. 64; counter-clockwise seen from its front
  std::uint32_t object = 0;        ///< into Scene::objects
  std::uint32_t material = 0;      ///< into Scene::materials
  std::uint32_t obj_line = 0;      ///< 1-based line of scene.obj, for messages
};

struct Material {
  std::string name;
  Rgb reflectance;    ///< 0 .. kReflectanceMax; that of a texture is its mean
  Rgb exitance_w_m2;  ///< of the front, where the animation does not key it  [W/m^2]
  bool both_sides = true;
  std::int32_t texture = -1;  ///< into Scene::textures: reflectance where a polygon has Uvs; -1: none
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

  /// What images show, not what is lit. Of each corner, or empty where no corner of any polygon has one; of
  /// the corners of a polygon all have one or none (kNoIndex).
  std::vector<std::uint32_t> corner_uvs;      ///< into uvs; empty too where no material has a texture
  std::vector<std::uint32_t> corner_normals;  ///< into normals
  std::vector<Uv> uvs;
  std::vector<Vec3> normals;  ///< unit, object space; smooth shading as the file says it
  std::vector<Texture> textures;

  std::vector<SceneObject> objects;   ///< [0] is ""; then those of animation.json, by name
  std::vector<Material> materials;    ///< those that polygons use, in order of first use
  std::vector<std::string> warnings;  ///< for people: ignored statements, polygons left out, ...
};

/// Limits on what a scene may hold; beyond them load_scene answers out_of_resources.
struct SceneLimits {
  std::size_t vertices = 20'000'000;  ///< and as many texture coordinates and normals
  std::size_t polygons = 10'000'000;
  std::size_t objects = 100'000;
  std::size_t materials = 10'000;
  std::size_t line_bytes = 64u << 10;
  std::size_t texture_pixels = 64u << 20;  ///< of all textures together; 3 bytes each
};

/// Reads a texture of at most `pixels_max` pixels. engine/image/texture_file.h has the one for PNG and JPEG.
/// Error: invalid_request where it cannot be read, out_of_resources where it is larger.
using TextureReader =
    std::function<api::Result<Texture>(const std::filesystem::path& texture, std::size_t pixels_max)>;

/// Refuses every texture.
api::Result<Texture> refuse_texture(const std::filesystem::path& texture, std::size_t pixels_max);

/// Reads `input_folder`/scene.obj and the MTL files and textures it names (by base name, without regard to
/// case, regular files in `input_folder` only), and applies `description`'s materials and unit. Polygons
/// without area are dropped with a warning. An MTL's Ke is radiance, so exitance = pi Ke; faces before any
/// usemtl get the material "" that reflects half.
///
/// A texture (map_Kd) replaces Kd, and a reflectance in animation.json replaces both. By the letter of the
/// MTL format map_Kd is multiplied by Kd; but exporters write any Kd beside it (1, 0.8, 0), which the
/// programs that they serve do not read. Options of map_Kd (-s, -o, ...) are ignored with a warning.
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
///   unknown_parent              an object or light is carried by what `description.objects` has not
///   out_of_range                |coordinate| > 1e7 units or metres, Kd < 0 or >= 1, Ke < 0. Kd of exactly 1
///                               is refused too: such light never dies
///   unreadable_texture          what `texture_reader` says
///   no_light                    neither a polygon nor a light of `description` emits in any frame, unless
///                               `description.allow_dark` (file animation.json, pointer "": that is where
///                               light is most easily added)
/// out_of_resources, code limit_exceeded: beyond `limits`. internal: the file system fails. stopped: where
/// `stop_requested`, which is asked every few milliseconds while the OBJ is read, and then now and then.
api::Result<Scene> load_scene(
    const std::filesystem::path& input_folder, const api::SceneDescription& description,
    const SceneLimits& limits = {}, const TextureReader& texture_reader = refuse_texture,
    const std::function<bool()>& stop_requested = [] { return false; });

}  // namespace engine
