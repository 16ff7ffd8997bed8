// The names usemtl says -> materials, from the MTL files and animation.json.
#pragma once

#include <string>
#include <vector>

#include "api/result.h"
#include "engine/scene/input_files.h"
#include "engine/scene/obj_file.h"
#include "engine/scene/scene.h"

namespace engine {

/// One Material per entry of `obj.materials`, in that order. What animation.json gives wins over the MTL, and
/// what it replaces is not checked. Violations are added to `violations`; then the answer is of no use.
/// Error: as read_mtl_file; internal where `texture_mean` says so.
api::Result<std::vector<Material>> resolve_materials(const ObjFile& obj, const InputFiles& files,
                                                     const api::SceneDescription& description,
                                                     const SceneLimits& limits,
                                                     const TextureMean& texture_mean,
                                                     std::vector<api::Violation>& violations,
                                                     std::vector<std::string>& warnings);

}  // namespace engine
