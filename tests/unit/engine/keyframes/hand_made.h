// Estimates made by hand, for the tests of what is made of them.
#pragma once

#include <functional>
#include <vector>

#include "engine/estimate/estimate_lighting.h"
#include "tests/unit/engine/keyframes/series.h"

namespace tests {

/// value(replicate, patch, frame): what is interpolated, of one group of scale 1; `radiosity` is known.
inline engine::Estimate estimate_of(
    const World& world, const engine::PatchSeries& radiosity,
    const std::function<float(std::uint32_t, std::uint32_t, std::uint32_t)>& value) {
  engine::Estimate estimate;
  estimate.patches = world.patches;
  estimate.groups.push_back({{"", world.animation.emission, {engine::Rgb{1, 1, 1}}}, {}});
  estimate.radiosity_w_m2 = radiosity;
  estimate.interpolated.emplace_back();
  for (std::uint32_t r = 0; r < engine::kEstimateReplicates; ++r)
    estimate.interpolated[0].push_back(
        series(radiosity.patch_count, radiosity.frame_count,
               [&](std::uint32_t p, std::uint32_t f) { return value(r, p, f); }));
  return estimate;
}

}  // namespace tests
