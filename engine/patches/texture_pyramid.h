// A texture, and the same at half the size, a quarter, ... down to a single texel, for means over areas.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/rgb.h"
#include "engine/scene/texture.h"

namespace engine {

/// No texel reflects more: pictures are often pure white, and light in a white room would take a million
/// bounces to die, for a thousandth of difference in what is seen.
inline constexpr float kTexelMax = 0.999f;

/// Texels cover the plane evenly: texel (x, y) is [x, x + 1) / width x [y, y + 1) / height, y downwards.
struct TextureLevel {
  std::uint32_t width = 1, height = 1;
  std::vector<Rgb> texels;  ///< linear reflectance, row by row from the top
};

/// Level 0 is the texture itself, which outlives this; each of the next is ceil(half) the size, its texels
/// the means over the areas that they cover, so every level has the mean of the texture; the last has one
/// texel.
struct TexturePyramid {
  const Texture* finest = nullptr;
  std::vector<TextureLevel> coarser;  ///< [level - 1]

  std::uint32_t level_count() const { return static_cast<std::uint32_t>(coarser.size()) + 1; }
  std::uint32_t width(std::uint32_t level) const {
    return level == 0 ? finest->width : coarser[level - 1].width;
  }
  std::uint32_t height(std::uint32_t level) const {
    return level == 0 ? finest->height : coarser[level - 1].height;
  }
  /// 0 .. kTexelMax; x < width, y < height.
  Rgb at(std::uint32_t level, std::uint32_t x, std::uint32_t y) const;
};

TexturePyramid build_pyramid(const Texture& finest);

/// i modulo size, for the texture's repetition; size > 0.
inline std::uint32_t wrapped(std::int64_t i, std::uint32_t size) {
  const std::int64_t rest = i % static_cast<std::int64_t>(size);
  return static_cast<std::uint32_t>(rest < 0 ? rest + size : rest);
}

}  // namespace engine
