#include "engine/scene/texture.h"

#include <cmath>

namespace engine {
namespace {

/// Linear light of the 256 levels of sRGB, below one.
const std::array<float, 256>& linear_of_srgb() {
  static const auto kLinear = [] {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const double v = double(i) / 255;
      const double light = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
      linear[i] = std::min(static_cast<float>(light), kReflectanceMax);
    }
    return linear;
  }();
  return kLinear;
}

/// The two pixels of a row or column next to a coordinate, and how far it is from the first to the second.
struct Neighbours {
  std::uint32_t first, second;
  float fraction;
};

/// `t` in turns of the texture; pixel k is centred on (k + 1/2) / count.
Neighbours neighbours_of(float t, std::uint32_t count) {
  const double along = (double{t} - std::floor(double{t})) * count - 0.5;  // -1/2 .. count - 1/2
  const double below = std::floor(along);
  const auto first = static_cast<std::uint32_t>(below + count) % count;
  return {first, (first + 1) % count, static_cast<float>(along - below)};
}

Rgb between(Rgb a, Rgb b, float fraction) {
  return a * (1 - fraction) + b * fraction;
}

}  // namespace

Rgb texel(const Texture& texture, std::uint32_t x, std::uint32_t y) {
  const auto& linear = linear_of_srgb();
  const auto& level = texture.srgb[std::size_t{y} * texture.width + x];
  return {linear[level[0]], linear[level[1]], linear[level[2]]};
}

Rgb reflectance_at(const Texture& texture, Uv at) {
  const Neighbours x = neighbours_of(at.u, texture.width);
  const Neighbours y = neighbours_of(-at.v, texture.height);  // v goes up, rows go down
  const auto row = [&](std::uint32_t k) {
    return between(texel(texture, x.first, k), texel(texture, x.second, k), x.fraction);
  };
  return between(row(y.first), row(y.second), y.fraction);
}

Rgb mean_reflectance(const Texture& texture) {
  // Counting levels first is exact, and one table look-up per level instead of per pixel.
  std::array<std::array<std::uint64_t, 256>, 3> counts{};
  for (const auto& pixel : texture.srgb)
    for (std::size_t c = 0; c < 3; ++c) ++counts[c][pixel[c]];
  const auto mean = [&](std::size_t c) {
    double sum = 0;
    for (std::size_t level = 0; level < 256; ++level)
      sum += double(counts[c][level]) * linear_of_srgb()[level];
    return static_cast<float>(sum / double(texture.srgb.size()));
  };
  return {mean(0), mean(1), mean(2)};
}

}  // namespace engine
