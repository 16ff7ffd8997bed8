// A picture as the bytes of a JPEG file.
#pragma once

#include <string>

#include "api/result.h"
#include "engine/image/image.h"

namespace engine {

/// Baseline JFIF of quality 90, colours at full resolution (4:4:4: edges between colours stay sharp); nothing
/// about time or machine, so equal pictures are equal bytes. Source of the format: ITU-T T.81 and T.871.
/// Error: internal with the encoder's own words.
api::Result<std::string> jpeg_bytes(const ScreenImage& image);

}  // namespace engine
