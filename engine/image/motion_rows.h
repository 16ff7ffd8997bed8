// Where in a picture things that move can be.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/image/camera.h"
#include "engine/patches/patches.h"

namespace engine {

/// Pixels x0 <= x < x1 of a row.
struct PixelSpan {
  std::uint32_t x0 = 0, x1 = 0;
};

/// [row]: spans apart from each other, from left to right.
using MotionRows = std::vector<std::vector<PixelSpan>>;

/// The pixels that can see an object that moves and is there in `frame`, with a pixel to spare on each side.
/// In every row one span per object, from the leftmost of its facets to the rightmost.
MotionRows rows_with_motion(const Patches& patches, const Animation& animation, FrameIndex frame,
                            const PinholeCamera& camera);

/// Every pixel.
MotionRows whole_rows(const PinholeCamera& camera);

}  // namespace engine
