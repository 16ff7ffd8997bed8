#include "engine/scene/mtl_library.h"

#include <set>

#include "engine/scene/found.h"

namespace engine {
namespace {

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

api::Status read_library(const std::filesystem::path& path, const SceneLimits& limits, Violations& all,
                         std::vector<std::string>& warnings, MtlLibrary& library) {
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

}  // namespace

api::Result<MtlLibrary> read_mtl_library(const ObjFile& obj, const InputFiles& files,
                                         const SceneLimits& limits, Violations& all,
                                         std::vector<std::string>& warnings) {
  MtlLibrary library;
  FileViolations obj_violations{kObjFile, all};
  std::set<std::filesystem::path> read;
  for (const NamedPlace& line : obj.libraries) {
    if (obj_violations.full()) break;
    for (const NamedPlace& name : library_names(line, files)) {
      const auto path = find_input_file(files, name.name);
      if (!path) {
        library.complete = false;
        obj_violations.add(
            name.line, name.column, "missing_file",
            "material file " + excerpt(base_name(name.name)) +
                " is not among the job's files; send it with the scene, as one of its materials");
      } else if (read.insert(*path).second) {
        if (const auto status = read_library(*path, limits, all, warnings, library); !status)
          return status.error();
      }
    }
  }
  return library;
}

}  // namespace engine
