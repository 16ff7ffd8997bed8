#include "engine/patches/texture_pyramid.h"

#include <algorithm>

#include "engine/base/parallel.h"

namespace engine {
namespace {

/// What a texel of the coarser level takes from one line of the finer one: texels first .. first + 2.
struct Cover {
  std::uint32_t first = 0;
  float share[3] = {0, 0, 0};
};

/// One axis: `coarse` = ceil(fine / 2) parts of fine / coarse texels each, 1 to 2 of them, so that a part
/// meets 3 at most.
std::vector<Cover> covers(std::uint32_t fine, std::uint32_t coarse) {
  const double length = static_cast<double>(fine) / coarse;
  std::vector<Cover> parts(coarse);
  for (std::uint32_t k = 0; k < coarse; ++k) {
    const double low = k * length, high = std::min((k + 1) * length, static_cast<double>(fine));
    Cover& part = parts[k];
    part.first = std::min(static_cast<std::uint32_t>(low), fine - 1);
    for (std::uint32_t c = 0; c < 3; ++c) {
      const double from = std::max(low, static_cast<double>(part.first + c));
      const double to = std::min(high, static_cast<double>(part.first + c + 1));
      part.share[c] = static_cast<float>(std::max(0.0, to - from) / length);
    }
  }
  return parts;
}

TextureLevel coarser(const TexturePyramid& pyramid, std::uint32_t of) {
  const std::uint32_t width = pyramid.width(of), height = pyramid.height(of);
  TextureLevel level{(width + 1) / 2, (height + 1) / 2, {}};
  level.texels.resize(std::size_t{level.width} * level.height);
  const std::vector<Cover> columns = covers(width, level.width), rows = covers(height, level.height);
  parallel_for(level.height, [&](std::size_t y) {
    for (std::uint32_t x = 0; x < level.width; ++x) {
      Rgb sum;
      for (std::uint32_t j = 0; j < 3; ++j)
        for (std::uint32_t i = 0; i < 3; ++i)
          if (const float share = rows[y].share[j] * columns[x].share[i]; share > 0)
            sum += share * pyramid.at(of, columns[x].first + i, rows[y].first + j);
      level.texels[y * level.width + x] = sum;
    }
  });
  return level;
}

}  // namespace

Rgb TexturePyramid::at(std::uint32_t level, std::uint32_t x, std::uint32_t y) const {
  if (level > 0) return coarser[level - 1].texels[std::size_t{y} * coarser[level - 1].width + x];
  const Rgb found = texel(*finest, x, y);
  return {std::min(found.r, kTexelMax), std::min(found.g, kTexelMax), std::min(found.b, kTexelMax)};
}

TexturePyramid build_pyramid(const Texture& finest) {
  TexturePyramid pyramid{&finest, {}};
  for (std::uint32_t level = 0; pyramid.width(level) > 1 || pyramid.height(level) > 1; ++level)
    pyramid.coarser.push_back(coarser(pyramid, level));
  return pyramid;
}

}  // namespace engine
