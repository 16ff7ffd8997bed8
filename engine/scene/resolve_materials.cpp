#include "engine/scene/resolve_materials.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>

#include "api/pointer_step.h"
#include "engine/scene/found.h"
#include "engine/scene/mtl_library.h"

namespace engine {
namespace {

constexpr Rgb kDefaultReflectance{0.5f, 0.5f, 0.5f};
constexpr double kRadianceMax = 1e12;  // its sums still fit single precision

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Given as below 1, but single precision may round it up.
Rgb reflectance_of(const api::Vec3& rho) {
  const auto channel = [&](int i) { return std::min(static_cast<float>(rho[i]), kReflectanceMax); };
  return {channel(0), channel(1), channel(2)};
}

class MaterialResolver {
 public:
  MaterialResolver(const InputFiles& files, const SceneLimits& limits, const TextureReader& texture_reader,
                   std::vector<api::Violation>& violations, std::vector<std::string>& warnings)
      : files_(files),
        pixels_left_(limits.texture_pixels),
        texture_reader_(texture_reader),
        violations_(violations),
        warnings_(warnings) {}

  /// Sets reflectance and texture.
  api::Status reflect(const MtlMaterial& mtl, Material& material);
  Rgb exitance(const MtlMaterial& mtl);
  std::vector<Texture> textures() { return std::move(textures_); }

 private:
  api::Result<std::int32_t> read(const std::filesystem::path& path);
  api::Status reflect_texture(const MtlMaterial& mtl, Material& material);
  void warn(const MtlMaterial& mtl, const std::string& what) {
    warnings_.push_back(mtl.file + ": material " + excerpt(mtl.name.name) + what);
  }

  const InputFiles& files_;
  std::size_t pixels_left_;
  const TextureReader& texture_reader_;
  std::vector<api::Violation>& violations_;
  std::vector<std::string>& warnings_;
  std::vector<Texture> textures_;
  std::map<std::filesystem::path, api::Result<std::int32_t>> read_;  ///< a texture of many materials: once
};

std::string remedy(const MtlMaterial& mtl) {
  return "set /materials/" + api::pointer_step(mtl.name.name) + "/reflectance in animation.json";
}

/// The number of the texture.
api::Result<std::int32_t> MaterialResolver::read(const std::filesystem::path& path) {
  if (const auto known = read_.find(path); known != read_.end()) return known->second;
  auto texture = texture_reader_(path, pixels_left_);
  if (!texture) return read_.emplace(path, texture.error()).first->second;
  pixels_left_ -= std::min(pixels_left_, texture->srgb.size());
  textures_.push_back(std::move(*texture));
  return read_.emplace(path, static_cast<std::int32_t>(textures_.size() - 1)).first->second;
}

api::Status MaterialResolver::reflect_texture(const MtlMaterial& mtl, Material& material) {
  const NamedPlace& map = mtl.map_kd;
  FileViolations violations{mtl.file, violations_};
  const std::string name = excerpt(base_name(map.name));
  const auto path = find_input_file(files_, map.name);
  if (!path) {
    violations.add(map.line, map.column, "missing_file",
                   "texture " + name + " is not among the job's files; send it, or " + remedy(mtl));
    return api::Done{};
  }
  const auto texture = read(*path);
  if (!texture && texture.error().fault == api::Fault::internal) return texture.error();
  if (!texture) {
    violations.add(map.line, map.column, "unreadable_texture", name + ": " + texture.error().message);
    return api::Done{};
  }
  material.texture = *texture;
  material.reflectance = mean_reflectance(textures_[std::size_t(*texture)]);
  if (max_channel(material.reflectance) >= kReflectanceMax)
    violations.add(
        map.line, map.column, "out_of_range",
        "texture " + name + " reflects everything; a reflectance is below 1. Change it, or " + remedy(mtl));
  if (mtl.map_kd_has_options) warn(mtl, ": the options of its map_Kd are ignored");
  return api::Done{};
}

api::Status MaterialResolver::reflect(const MtlMaterial& mtl, Material& material) {
  if (mtl.map_kd.line > 0) return reflect_texture(mtl, material);
  const MtlColour& kd = mtl.kd;
  if (kd.line == 0) {
    warn(mtl, " has no Kd; it reflects half");
    return api::Done{};
  }
  const auto [low, high] = std::minmax({kd.r, kd.g, kd.b});
  if (low < 0 || static_cast<float>(high) >= 1)
    FileViolations{mtl.file, violations_}.add(
        kd.line, kd.column, "out_of_range",
        "material " + excerpt(mtl.name.name) + " reflects " + text_of(low < 0 ? low : high) +
            "; a reflectance is at least 0 and below 1. Change it, or " + remedy(mtl));
  material.reflectance = reflectance_of({kd.r, kd.g, kd.b});
  return api::Done{};
}

Rgb MaterialResolver::exitance(const MtlMaterial& mtl) {
  const auto [low, high] = std::minmax({mtl.ke.r, mtl.ke.g, mtl.ke.b});
  if (low < 0 || high > kRadianceMax)
    FileViolations{mtl.file, violations_}.add(mtl.ke.line, mtl.ke.column, "out_of_range",
                                              "material " + excerpt(mtl.name.name) + " emits " +
                                                  text_of(low < 0 ? low : high) +
                                                  "; a radiance is 0 .. 1e12");
  const auto channel = [](double radiance) { return static_cast<float>(std::numbers::pi * radiance); };
  return {channel(mtl.ke.r), channel(mtl.ke.g), channel(mtl.ke.b)};
}

/// What animation.json gives replaces what the MTL says, which then is not looked at.
api::Result<Material> material_of(const NamedPlace& use, const MtlMaterial* mtl,
                                  const api::MaterialSettings& given, MaterialResolver& resolver) {
  Material material{use.name, kDefaultReflectance, {}, given.sides != api::Sides::front, -1};
  if (given.reflectance.given()) {
    material.reflectance = reflectance_of(given.reflectance.keys.front().value);
  } else if (mtl) {
    if (const auto done = resolver.reflect(*mtl, material); !done) return done.error();
  }
  if (given.exitance_w_m2.given()) {
    const api::Vec3& first = given.exitance_w_m2.keys.front().value;
    material.exitance_w_m2 = {static_cast<float>(first[0]), static_cast<float>(first[1]),
                              static_cast<float>(first[2])};
  } else if (mtl) {
    material.exitance_w_m2 = resolver.exitance(*mtl);
  }
  return material;
}

/// Names in animation.json that no polygon can have.
void check_description(const ObjFile& obj, const MtlLibrary& library, const std::vector<std::string>& known,
                       const api::SceneDescription& description, std::vector<api::Violation>& all,
                       std::vector<std::string>& warnings) {
  std::set<std::string> used;
  for (const NamedPlace& material : obj.materials) used.insert(material.name);
  for (const auto& [name, settings] : description.materials) {
    if (used.contains(name)) continue;
    if (library.materials.contains(name)) {
      warnings.push_back(std::string(kAnimationFile) + ": no face has the material " + excerpt(name));
    } else if (library.complete && all.size() < api::kViolationsMax) {
      all.push_back({kAnimationFile, "/materials/" + api::pointer_step(name), 0, 0, "unknown_material",
                     "the MTL files have no material " + excerpt(name) + did_you_mean(name, known)});
    }
  }
}

}  // namespace

api::Result<ResolvedMaterials> resolve_materials(const ObjFile& obj, const InputFiles& files,
                                                 const api::SceneDescription& description,
                                                 const KnownParts& known_parts, const SceneLimits& limits,
                                                 const TextureReader& texture_reader,
                                                 std::vector<api::Violation>& violations,
                                                 std::vector<std::string>& warnings) {
  const auto library = read_mtl_library(obj, files, limits, violations, warnings);
  if (!library) return library.error();
  std::vector<std::string> known;
  for (const auto& [name, material] : library->materials) known.push_back(name);

  MaterialResolver resolver(files, limits, texture_reader, violations, warnings);
  std::vector<Material> materials;
  for (const NamedPlace& use : obj.materials) {
    const auto mtl = library->materials.find(use.name);
    const bool is_defined = mtl != library->materials.end();
    if (use.line == 0)
      warnings.push_back(std::string(kObjFile) +
                         ": faces before any usemtl get a material that reflects half");
    else if (!is_defined && library->complete)
      FileViolations{kObjFile, violations}.add(
          use.line, use.column, "unknown_material",
          "no MTL file has the material " + excerpt(use.name) +
              (obj.libraries.empty() ? "; the OBJ has no 'mtllib'" : "") + did_you_mean(use.name, known));
    const auto settings = description.materials.find(use.name);
    const bool is_set = settings != description.materials.end();
    auto material = material_of(use, is_defined && known_parts.settings(use.name) ? &mtl->second : nullptr,
                                is_set ? settings->second : api::MaterialSettings{}, resolver);
    if (!material) return material.error();
    materials.push_back(std::move(*material));
  }
  if (known_parts.all_uses) check_description(obj, *library, known, description, violations, warnings);
  return ResolvedMaterials{std::move(materials), resolver.textures()};
}

}  // namespace engine
