#include "engine/image/texture_filter.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// The two texels of a row or column next to a coordinate, and how far it is from the first to the second.
struct Neighbours {
  std::uint32_t first = 0, second = 0;
  float fraction = 0;
};

/// `turns` of the texture; texel k is centred on (k + 1/2) / count.
Neighbours neighbours_of(double turns, std::uint32_t count) {
  const double along = (turns - std::floor(turns)) * count - 0.5;
  const double below = std::floor(along);
  const auto k = static_cast<std::int64_t>(below);
  return {wrapped(k, count), wrapped(k + 1, count), static_cast<float>(along - below)};
}

Rgb colour_between(Rgb a, Rgb b, float fraction) {
  return (1 - fraction) * a + fraction * b;
}

Rgb on_level(const TexturePyramid& texture, std::uint32_t level, TexturePoint at) {
  const Neighbours x = neighbours_of(at.u, texture.width(level));
  const Neighbours y = neighbours_of(-at.v, texture.height(level));  // v goes up, rows go down
  const auto row = [&](std::uint32_t k) {
    return colour_between(texture.at(level, x.first, k), texture.at(level, x.second, k), x.fraction);
  };
  return colour_between(row(y.first), row(y.second), y.fraction);
}

/// `width`: of what is averaged, in texels of the finest level.
Rgb between_levels(const TexturePyramid& texture, double width, TexturePoint at) {
  const std::uint32_t coarsest = texture.level_count() - 1;
  const double level = std::clamp(std::log2(std::max(width, 1.0)), 0.0, static_cast<double>(coarsest));
  const auto finer = static_cast<std::uint32_t>(level);
  const auto fraction = static_cast<float>(level - finer);
  const Rgb fine = on_level(texture, finer, at);
  return fraction > 0 ? colour_between(fine, on_level(texture, finer + 1, at), fraction) : fine;
}

}  // namespace

Rgb filtered_reflectance(const TexturePyramid& texture, TexturePoint at, const TextureFootprint& footprint) {
  const auto texels = [&](TexturePoint step) {
    return std::hypot(step.u * texture.width(0), step.v * texture.height(0));
  };
  TexturePoint along = footprint.right, across = footprint.down;
  if (texels(along) < texels(across)) std::swap(along, across);
  const double length = texels(along), width = std::max(texels(across), 1.0);
  if (!(length > 1)) return on_level(texture, 0, at);  // also where a number got out of hand
  const int probes = static_cast<int>(std::clamp(std::ceil(length / width), 1.0, double{kProbesMax}));
  Rgb sum;
  for (int k = 0; k < probes; ++k) {
    const double step = (k + 0.5) / probes - 0.5;
    sum += between_levels(texture, std::max(width, length / probes),
                          {at.u + step * along.u, at.v + step * along.v});
  }
  return sum * (1.0f / static_cast<float>(probes));
}

}  // namespace engine
