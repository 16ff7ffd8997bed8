#include "engine/scene/resolve_materials.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>

#include "api/pointer_step.h"
#include "engine/scene/mtl_library.h"

namespace engine {
namespace {

constexpr const char* kObj = "scene.obj";
constexpr const char* kAnimation = "animation.json";
constexpr Rgb kDefaultReflectance{0.5f, 0.5f, 0.5f};
constexpr double kRadianceMax = 1e12;  // its sums still fit single precision

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Given as below 1, but single precision may round it up.
Rgb reflectance_of(const api::Vec3& rho) {
  const float below_one = std::nextafter(1.0f, 0.0f);
  const auto channel = [&](int i) { return std::min(static_cast<float>(rho[i]), below_one); };
  return {channel(0), channel(1), channel(2)};
}

class MaterialResolver {
 public:
  MaterialResolver(const InputFiles& files, const SceneLimits& limits, const TextureMean& texture_mean,
                   std::vector<api::Violation>& violations, std::vector<std::string>& warnings)
      : files_(files),
        limits_(limits),
        texture_mean_(texture_mean),
        violations_(violations),
        warnings_(warnings) {}

  api::Result<Rgb> reflectance(const MtlMaterial& mtl);
  Rgb exitance(const MtlMaterial& mtl);

 private:
  api::Result<MtlColour> texture(const MtlMaterial& mtl);
  void warn(const MtlMaterial& mtl, const std::string& what) {
    warnings_.push_back(mtl.file + ": material " + excerpt(mtl.name.name) + what);
  }

  const InputFiles& files_;
  const SceneLimits& limits_;
  const TextureMean& texture_mean_;
  std::vector<api::Violation>& violations_;
  std::vector<std::string>& warnings_;
  std::map<std::filesystem::path, api::Result<Rgb>> means_;  ///< a texture of many materials is read once
};

std::string remedy(const MtlMaterial& mtl) {
  return "set /materials/" + api::pointer_step(mtl.name.name) + "/reflectance in animation.json";
}

/// The mean of map_Kd, placed where map_Kd stands; black after a violation.
api::Result<MtlColour> MaterialResolver::texture(const MtlMaterial& mtl) {
  const NamedPlace& map = mtl.map_kd;
  const std::string name = excerpt(base_name(map.name));
  const auto path = find_input_file(files_, map.name);
  if (!path) {
    FileViolations{mtl.file, violations_}.add(
        map.line, map.column, "missing_file",
        "texture " + name + " is not among the job's files; send it, or " + remedy(mtl));
    return MtlColour{};
  }
  auto known = means_.find(*path);
  if (known == means_.end())
    known = means_.emplace(*path, texture_mean_(*path, limits_.texture_pixels)).first;
  const api::Result<Rgb>& mean = known->second;
  if (!mean && mean.error().fault == api::Fault::internal) return mean.error();
  if (!mean) {
    FileViolations{mtl.file, violations_}.add(map.line, map.column, "unreadable_texture",
                                              name + ": " + mean.error().message);
    return MtlColour{};
  }
  warn(mtl, ": texture " + name + " is reduced to its mean reflectance, " + text_of(mean->r) + " " +
                text_of(mean->g) + " " + text_of(mean->b) + " (linear)");
  return MtlColour{mean->r, mean->g, mean->b, map.line, map.column};
}

api::Result<Rgb> MaterialResolver::reflectance(const MtlMaterial& mtl) {
  MtlColour kd = mtl.kd;
  if (mtl.map_kd.line > 0) {
    const auto mean = texture(mtl);
    if (!mean) return mean.error();
    kd = *mean;
  } else if (kd.line == 0) {
    warn(mtl, " has no Kd; it reflects half");
    return kDefaultReflectance;
  }
  const auto [low, high] = std::minmax({kd.r, kd.g, kd.b});
  const Rgb rgb{static_cast<float>(kd.r), static_cast<float>(kd.g), static_cast<float>(kd.b)};
  if (low < 0 || max_channel(rgb) >= 1)
    FileViolations{mtl.file, violations_}.add(
        kd.line, kd.column, "out_of_range",
        "material " + excerpt(mtl.name.name) + " reflects " + text_of(low < 0 ? low : high) +
            "; a reflectance is at least 0 and below 1. Change it, or " + remedy(mtl));
  return rgb;
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
  Material material{use.name, kDefaultReflectance, {}, given.sides != api::Sides::front};
  if (given.reflectance.given()) {
    material.reflectance = reflectance_of(given.reflectance.keys.front().value);
  } else if (mtl) {
    const auto reflectance = resolver.reflectance(*mtl);
    if (!reflectance) return reflectance.error();
    material.reflectance = *reflectance;
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
      warnings.push_back(std::string(kAnimation) + ": no face has the material " + excerpt(name));
    } else if (library.complete && all.size() < api::kViolationsMax) {
      all.push_back({kAnimation, "/materials/" + api::pointer_step(name), 0, 0, "unknown_material",
                     "the MTL files have no material " + excerpt(name) + did_you_mean(name, known)});
    }
  }
}

}  // namespace

api::Result<std::vector<Material>> resolve_materials(const ObjFile& obj, const InputFiles& files,
                                                     const api::SceneDescription& description,
                                                     const SceneLimits& limits,
                                                     const TextureMean& texture_mean,
                                                     std::vector<api::Violation>& violations,
                                                     std::vector<std::string>& warnings) {
  const auto library = read_mtl_library(obj, files, limits, violations, warnings);
  if (!library) return library.error();
  std::vector<std::string> known;
  for (const auto& [name, material] : library->materials) known.push_back(name);

  MaterialResolver resolver(files, limits, texture_mean, violations, warnings);
  std::vector<Material> materials;
  for (const NamedPlace& use : obj.materials) {
    const auto mtl = library->materials.find(use.name);
    const bool is_defined = mtl != library->materials.end();
    if (use.line == 0)
      warnings.push_back(std::string(kObj) + ": faces before any usemtl get a material that reflects half");
    else if (!is_defined && library->complete)
      FileViolations{kObj, violations}.add(use.line, use.column, "unknown_material",
                                           "no MTL file has the material " + excerpt(use.name) +
                                               (obj.libraries.empty() ? "; the OBJ has no 'mtllib'" : "") +
                                               did_you_mean(use.name, known));
    const auto settings = description.materials.find(use.name);
    const bool is_set = settings != description.materials.end();
    auto material = material_of(use, is_defined ? &mtl->second : nullptr,
                                is_set ? settings->second : api::MaterialSettings{}, resolver);
    if (!material) return material.error();
    materials.push_back(std::move(*material));
  }
  check_description(obj, *library, known, description, violations, warnings);
  return materials;
}

}  // namespace engine
