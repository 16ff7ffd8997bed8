// A texture reduced to the one colour that a radiosity patch can have.
#pragma once

#include <cstddef>
#include <filesystem>

#include "api/result.h"
#include "engine/base/rgb.h"

namespace engine {

inline constexpr int kTextureEdgeMax = 8192;  ///< [pixels]

/// Mean over the pixels of a PNG or JPEG file (told by its first bytes, not by its name) of the linear
/// reflectance that its sRGB values stand for (IEC 61966-2-1), 0 .. 1. Grey is repeated; alpha is not read.
/// The size is judged by the file's header, before any pixel is decoded.
///
/// Error: invalid_request where it is no such file or is damaged, out_of_resources beyond kTextureEdgeMax in
/// either direction or `pixels_max` in all. As a parameter of load_scene: the default for jobs.
api::Result<Rgb> mean_reflectance_of_texture(const std::filesystem::path& texture, std::size_t pixels_max);

}  // namespace engine
