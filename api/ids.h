// Index types shared by every layer.
#pragma once

#include <cstdint>

namespace api {

using FrameIndex = std::uint32_t;  ///< 0-based frame of the animation
using PatchId = std::uint32_t;     ///< one side of one planar surface element

}  // namespace api
