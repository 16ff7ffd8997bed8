// Every material that the MTL files of an OBJ define.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "api/result.h"
#include "engine/scene/input_files.h"
#include "engine/scene/mtl_file.h"
#include "engine/scene/obj_file.h"

namespace engine {

struct MtlLibrary {
  std::map<std::string, MtlMaterial> materials;  ///< by name; the first definition of a name counts
  bool complete = true;  ///< false: a file is missing or wrong, so a missing material means nothing
};

/// Reads the files that `obj.libraries` name, each once. A file that is not there is a violation of
/// scene.obj. Error: as read_mtl_file.
api::Result<MtlLibrary> read_mtl_library(const ObjFile& obj, const InputFiles& files,
                                         const SceneLimits& limits, std::vector<api::Violation>& violations,
                                         std::vector<std::string>& warnings);

}  // namespace engine
