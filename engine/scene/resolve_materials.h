// The names usemtl says -> materials, from the MTL files and animation.json.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "api/result.h"
#include "engine/scene/input_files.h"
#include "engine/scene/obj_file.h"
#include "engine/scene/scene.h"

namespace engine {

struct ResolvedMaterials {
  std::vector<Material> materials;  ///< one per entry of ObjFile::materials, in that order
  std::vector<Texture> textures;    ///< those that `materials` have, each once
};

/// What of a refused job can be relied on all the same.
struct KnownParts {
  bool all_uses = true;  ///< false: scene.obj was not read to its end, so faces may have more materials
  /// Is what animation.json says of this material what its author meant?
  std::function<bool(const std::string& material)> settings = [](const std::string&) { return true; };
};

/// What animation.json gives wins over the MTL, and what it replaces (or may replace: `known`) is not
/// checked. Violations are added to `violations`; then the answer is of no use. Error: as read_mtl_file;
/// internal where `texture_reader` says so.
api::Result<ResolvedMaterials> resolve_materials(const ObjFile& obj, const InputFiles& files,
                                                 const api::SceneDescription& description,
                                                 const KnownParts& known, const SceneLimits& limits,
                                                 const TextureReader& texture_reader,
                                                 std::vector<api::Violation>& violations,
                                                 std::vector<std::string>& warnings);

}  // namespace engine
