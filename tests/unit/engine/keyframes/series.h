// Patches that do nothing but carry hand-made radiosity, for the tests of key-frames.
#pragma once

#include <functional>
#include <utility>

#include "tests/unit/engine/scenes.h"

namespace tests {

/// `count` squares of 1 m^2 (one patch each) side by side; the last object is one that has no polygons.
inline engine::Scene squares(std::uint32_t count) {
  engine::Scene scene = scene_with(2, 1);
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto x = static_cast<float>(2 * k);
    add_polygon(scene, {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}});
  }
  return scene;
}

struct Squares : World {
  Squares(std::uint32_t count, engine::FrameIndex frames)
      : World(squares(count), still(squares(count), frames), 1.0) {}
};

/// A grey series: value(patch, frame) [W/m^2].
inline engine::PatchSeries series(std::uint32_t patches, std::uint32_t frames,
                                  const std::function<float(std::uint32_t, std::uint32_t)>& value) {
  engine::PatchSeries all(patches, frames);
  for (std::uint32_t p = 0; p < patches; ++p)
    for (std::uint32_t f = 0; f < frames; ++f) all.at(p, f) = engine::Rgb{1, 1, 1} * value(p, f);
  return all;
}

/// Straight between the knots (frame, value).
inline float through_knots(const std::vector<std::pair<std::uint32_t, float>>& knots, std::uint32_t frame) {
  for (std::size_t k = 1; k < knots.size(); ++k) {
    const auto& [first, from] = knots[k - 1];
    const auto& [last, to] = knots[k];
    if (frame <= last)
      return from + (to - from) * static_cast<float>(frame - first) / static_cast<float>(last - first);
  }
  return knots.back().second;
}

}  // namespace tests
