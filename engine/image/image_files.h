// EXR images as bytes of files, by the module of codecs.
#pragma once

#include <functional>
#include <string>

#include "api/result.h"
#include "engine/image/image.h"

namespace engine {

/// Half floats R, G, B: linear radiance with the primaries of Rec. 709, ZIP compression. Radiance above the
/// largest half is 65,504. Nothing about time or machine, so equal images are equal bytes.
/// Errors: stopped; internal with the encoder's own words, or where the module cannot be loaded.
api::Result<std::string> encode_exr(const Image& image, const std::function<bool()>& stop_requested);

}  // namespace engine
