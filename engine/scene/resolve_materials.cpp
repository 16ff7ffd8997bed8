#include "engine/scene/resolve_materials.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>

#include "engine/scene/mtl_file.h"

namespace engine {
namespace {

constexpr const char* kObj = "scene.obj";
constexpr const char* kAnimation = "animation.json";
constexpr float kDefaultReflectance = 0.5f;
constexpr double kRadianceMax = 1e12;  // its sums still fit single precision

using Violations = std::vector<api::Violation>;

/// Where the files lie that an mtllib names: the whole rest of the line is one name with spaces, or several.
std::vector<NamedPlace> library_names(const NamedPlace& library, const InputFiles& files) {
  if (find_input_file(files, library.name)) return {library};
  std::vector<NamedPlace> names;
  Tokens words(Statement{library.name, library.line});
  for (Token word; words.next(word);)
    names.push_back({std::string(word.text), library.line, library.column + word.column - 1});
  return names;
}

/// Every material of every MTL file, by name. `complete` is false when a file is missing or wrong.
struct Library {
  std::map<std::string, MtlMaterial> materials;
  bool complete = true;
};

api::Status read_library(const std::filesystem::path& path, const SceneLimits& limits, Violations& all,
                         std::vector<std::string>& warnings, Library& library) {
  FileViolations violations{utf8_name(path.filename().string()), all};
  IgnoredStatements ignored;
  std::vector<MtlMaterial> read;
  const std::size_t before = all.size();
  if (const auto status = read_mtl_file(path, limits, violations, ignored, read); !status) return status;
  if (all.size() > before) library.complete = false;
  ignored.report(violations.file, warnings);
  for (MtlMaterial& material : read) {
    const std::string name = material.name.name;
    const std::uint32_t line = material.name.line;
    if (!library.materials.try_emplace(name, std::move(material)).second)
      warnings.push_back(violations.file + ": line " + std::to_string(line) + ": material " + excerpt(name) +
                         " is defined before; the first definition counts");
  }
  return api::Done{};
}

api::Result<Library> read_libraries(const ObjFile& obj, const InputFiles& files, const SceneLimits& limits,
                                    Violations& all, std::vector<std::string>& warnings) {
  Library library;
  FileViolations obj_violations{kObj, all};
  std::set<std::filesystem::path> read;
  for (const NamedPlace& line : obj.libraries) {
    for (const NamedPlace& name : library_names(line, files)) {
      const auto path = find_input_file(files, name.name);
      if (!path) {
        library.complete = false;
        obj_violations.add(
            name.line, name.column, "missing_file",
            "material file " + excerpt(base_name(name.name)) + " is not among the job's files");
      } else if (read.insert(*path).second) {
        if (const auto status = read_library(*path, limits, all, warnings, library); !status)
          return status.error();
      }
    }
  }
  return library;
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// What the MTL says of reflectance, texture included.
api::Result<Rgb> mtl_reflectance(const MtlMaterial& mtl, const InputFiles& files, const SceneLimits& limits,
                                 const TextureMean& texture_mean, Violations& all,
                                 std::vector<std::string>& warnings) {
  FileViolations violations{mtl.file, all};
  const std::string remedy =
      "set /materials/" + pointer_step(mtl.name.name) + "/reflectance in animation.json";
  MtlColour kd = mtl.kd;
  if (mtl.map_kd.line > 0) {
    const std::string texture = excerpt(base_name(mtl.map_kd.name));
    const auto path = find_input_file(files, mtl.map_kd.name);
    const auto add = [&](std::string code, std::string detail) {
      violations.add(mtl.map_kd.line, mtl.map_kd.column, std::move(code), std::move(detail));
      return Rgb{};
    };
    if (!path)
      return add("missing_file",
                 "texture " + texture + " is not among the job's files; send it, or " + remedy);
    const auto mean = texture_mean(*path, limits.texture_pixels);
    if (!mean && mean.error().fault == api::Fault::internal) return mean.error();
    if (!mean) return add("unreadable_texture", texture + ": " + mean.error().message);
    kd = {mean->r, mean->g, mean->b, mtl.map_kd.line, mtl.map_kd.column};
    warnings.push_back(mtl.file + ": material " + excerpt(mtl.name.name) + ": texture " + texture +
                       " is reduced to its mean reflectance, " + text_of(kd.r) + " " + text_of(kd.g) + " " +
                       text_of(kd.b) + " (linear)");
  } else if (kd.line == 0) {
    warnings.push_back(mtl.file + ": material " + excerpt(mtl.name.name) + " has no Kd; it reflects half");
    return Rgb{kDefaultReflectance, kDefaultReflectance, kDefaultReflectance};
  }
  const auto [low, high] = std::minmax({kd.r, kd.g, kd.b});
  const Rgb reflectance{static_cast<float>(kd.r), static_cast<float>(kd.g), static_cast<float>(kd.b)};
  if (low < 0 || max_channel(reflectance) >= 1)
    violations.add(kd.line, kd.column, "out_of_range",
                   "material " + excerpt(mtl.name.name) + " reflects " + text_of(low < 0 ? low : high) +
                       "; a reflectance is at least 0 and below 1. Change it, or " + remedy);
  return reflectance;
}

Rgb mtl_exitance(const MtlMaterial& mtl, Violations& all) {
  const auto [low, high] = std::minmax({mtl.ke.r, mtl.ke.g, mtl.ke.b});
  if (low < 0 || high > kRadianceMax)
    FileViolations{mtl.file, all}.add(mtl.ke.line, mtl.ke.column, "out_of_range",
                                      "material " + excerpt(mtl.name.name) + " emits " +
                                          text_of(low < 0 ? low : high) + "; radiance is 0 .. 1e12");
  const auto exitance = [](double radiance) { return static_cast<float>(std::numbers::pi * radiance); };
  return {exitance(mtl.ke.r), exitance(mtl.ke.g), exitance(mtl.ke.b)};
}

Rgb rgb_of(const api::Vec3& value) {
  return {static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])};
}

/// Names in animation.json that no polygon can have.
void check_description(const ObjFile& obj, const Library& library, const api::SceneDescription& description,
                       Violations& all, std::vector<std::string>& warnings) {
  std::vector<std::string> known;
  std::set<std::string> used;
  for (const auto& [name, material] : library.materials) known.push_back(name);
  for (const NamedPlace& material : obj.materials) used.insert(material.name);
  for (const auto& [name, settings] : description.materials) {
    if (used.contains(name)) continue;
    if (library.materials.contains(name)) {
      warnings.push_back(std::string(kAnimation) + ": no face has the material " + excerpt(name));
    } else if (library.complete && all.size() < api::kViolationsMax) {
      all.push_back({kAnimation, "/materials/" + pointer_step(name), 0, 0, "unknown_material",
                     "the MTL files have no material " + excerpt(name) + did_you_mean(name, known)});
    }
  }
}

}  // namespace

api::Result<std::vector<Material>> resolve_materials(const ObjFile& obj, const InputFiles& files,
                                                     const api::SceneDescription& description,
                                                     const SceneLimits& limits,
                                                     const TextureMean& texture_mean, Violations& violations,
                                                     std::vector<std::string>& warnings) {
  const auto library = read_libraries(obj, files, limits, violations, warnings);
  if (!library) return library.error();
  std::vector<std::string> known;
  for (const auto& [name, material] : library->materials) known.push_back(name);

  std::vector<Material> materials;
  for (const NamedPlace& use : obj.materials) {
    Material material{use.name, {kDefaultReflectance, kDefaultReflectance, kDefaultReflectance}, {}, true};
    const auto settings = description.materials.find(use.name);
    const bool is_set = settings != description.materials.end();
    const auto mtl = library->materials.find(use.name);
    if (mtl != library->materials.end()) {
      if (!is_set || !settings->second.reflectance) {
        const auto reflectance =
            mtl_reflectance(mtl->second, files, limits, texture_mean, violations, warnings);
        if (!reflectance) return reflectance.error();
        material.reflectance = *reflectance;
      }
      if (!is_set || !settings->second.exitance_w_m2.given())
        material.exitance_w_m2 = mtl_exitance(mtl->second, violations);
    } else if (use.line == 0) {
      warnings.push_back(std::string(kObj) + ": faces before any usemtl get a material that reflects half");
    } else if (library->complete) {
      FileViolations{kObj, violations}.add(use.line, use.column, "unknown_material",
                                           "no MTL file has the material " + excerpt(use.name) +
                                               (obj.libraries.empty() ? "; the OBJ has no 'mtllib'" : "") +
                                               did_you_mean(use.name, known));
    }
    if (is_set) {
      const api::MaterialSettings& given = settings->second;
      if (given.reflectance) material.reflectance = rgb_of(*given.reflectance);
      if (given.exitance_w_m2.given()) material.exitance_w_m2 = rgb_of(given.exitance_w_m2.keys[0].value);
      if (given.sides) material.both_sides = *given.sides == api::Sides::both;
    }
    materials.push_back(std::move(material));
  }
  check_description(obj, *library, description, violations, warnings);
  return materials;
}

}  // namespace engine
