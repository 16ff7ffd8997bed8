// Textures from files.
#pragma once

#include <cstddef>
#include <filesystem>

#include "api/result.h"
#include "engine/scene/texture.h"

namespace engine {

inline constexpr int kTextureEdgeMax = 8192;  ///< [pixels]

/// The pixels of a PNG or JPEG file (told by its first bytes, not by its name), read as sRGB (IEC 61966-2-1)
/// whatever the file says of its colour space, rounded to 8 bits. Grey is repeated; alpha is not read. The
/// size is judged by the file's header, before any pixel is decoded.
///
/// Error: invalid_request where it is no such file or is damaged, out_of_resources beyond kTextureEdgeMax in
/// either direction or `pixels_max` in all, internal where the module of codecs cannot be loaded. As a
/// parameter of load_scene: the default for jobs.
api::Result<Texture> read_texture(const std::filesystem::path& file, std::size_t pixels_max);

}  // namespace engine
