// Rows of several frames, as they are rendered, into the pictures of each.
#pragma once

#include <cstdint>
#include <span>

#include "engine/image/image.h"
#include "engine/image/tone_map.h"

namespace engine {

/// `radiance`: row y of all frames, [x][channel][lane]; lane k belongs to images[k], of one size each. There
/// may be more lanes than images.
void store_row(std::span<const float> radiance, std::uint32_t y, std::span<Image> images);
void store_row(std::span<const float> radiance, std::uint32_t y, const DisplayTable& display,
               std::span<ScreenImage> images);

}  // namespace engine
