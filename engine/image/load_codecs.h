// The module of image codecs, loaded when something needs it first.
#pragma once

#include <filesystem>

#include "api/result.h"
#include "engine/image/codecs/interface.h"

namespace engine {

/// For EXR files and textures: the module that codecs_file names, loaded by the first call and kept until the
/// program ends. Safe for use by several threads. Error: that of open_codecs, at every call.
api::Result<const Codecs*> image_codecs();

/// Error: internal, naming the file and saying why, where it is missing, cannot be loaded, or is not of this
/// program's version.
api::Result<const Codecs*> open_codecs(const std::filesystem::path& file);

/// keylume-codecs.so in the folder of the program, as built, or in ../lib/keylume beside that, as installed;
/// the first where it is in neither.
std::filesystem::path codecs_file(const std::filesystem::path& program_folder);

/// For programs that lie elsewhere, as tests do. Call before the first use.
void use_codecs(const std::filesystem::path& file);

}  // namespace engine
