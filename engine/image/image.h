// Pictures in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/rgb.h"

namespace engine {

/// Radiance, linear RGB.  [W sr^-1 m^-2]
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<Rgb> pixels;  ///< row by row from the top, left to right

  Image() = default;
  Image(std::uint32_t w, std::uint32_t h) : width(w), height(h), pixels(std::size_t{w} * h) {}
  Rgb& at(std::uint32_t x, std::uint32_t y) { return pixels[std::size_t{y} * width + x]; }
  const Rgb& at(std::uint32_t x, std::uint32_t y) const { return pixels[std::size_t{y} * width + x]; }
};

/// What a screen shows: 8 bits per channel, sRGB.
struct ScreenImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> samples;  ///< r, g, b of each pixel, row by row from the top, left to right

  ScreenImage() = default;
  ScreenImage(std::uint32_t w, std::uint32_t h) : width(w), height(h), samples(std::size_t{3} * w * h) {}
};

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct PixelRect {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool contains(std::uint32_t x, std::uint32_t y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

}  // namespace engine
