// A picture of a surface: its diffuse reflectance by texture coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/rgb.h"

namespace engine {

/// No reflectance is above this, in single precision: light that never dies has no solution.
inline constexpr float kReflectanceMax = 0.999999f;

/// (0, 0) is the lower left corner of a texture, (1, 1) the upper right one; beyond, it repeats.
struct Uv {
  float u = 0, v = 0;
  friend bool operator==(const Uv&, const Uv&) = default;
};

struct Texture {
  std::uint32_t width = 0, height = 0;            ///< [pixels], > 0
  std::vector<std::array<std::uint8_t, 3>> srgb;  ///< rows from the top; IEC 61966-2-1
};

/// Reflectance of one pixel, linear RGB, 0 .. kReflectanceMax. x < width from the left, y < height from the
/// top.
Rgb texel(const Texture& texture, std::uint32_t x, std::uint32_t y);

/// Reflectance at `at`, linear between the centres of the four nearest pixels, across the edges too: a
/// texture repeats in both directions. u and v finite.
Rgb reflectance_at(const Texture& texture, Uv at);

/// Mean over all pixels.
Rgb mean_reflectance(const Texture& texture);

}  // namespace engine
