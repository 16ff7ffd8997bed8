// A picture as the bytes of a PNG file.
#pragma once

#include <string>

#include "api/result.h"
#include "engine/image/image.h"

namespace engine {

/// RGB, 8 bits per channel, sRGB (chunks sRGB, gAMA and cHRM); nothing about time or machine. Source of the
/// format: ISO/IEC 15948:2004 (PNG, second edition). libdeflate compresses the whole picture at once.
/// Error: internal where there is no memory for it.
api::Result<std::string> png_bytes(const ScreenImage& image);

}  // namespace engine
