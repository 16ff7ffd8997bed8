// Estimates made by hand, for the tests of what is made of them.
#pragma once

#include <functional>
#include <vector>

#include "engine/estimate/estimate.h"
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
  estimate.interpolated = engine::ReplicateSeries(radiosity.patch_count, radiosity.frame_count, 1);
  for (std::uint32_t r = 0; r < engine::kEstimateReplicates; ++r)
    for (std::uint32_t p = 0; p < radiosity.patch_count; ++p)
      for (std::uint32_t f = 0; f < radiosity.frame_count; ++f)
        estimate.interpolated.of_replicate(p, f, 0, r) = engine::Rgb{1, 1, 1} * value(r, p, f);
  estimate.interpolated.take_means();
  return estimate;
}

/// Makes what is interpolated of one patch, frame and group `value` in all replicates.
inline void set_all(engine::Estimate& estimate, std::uint32_t patch, std::uint32_t frame, std::uint32_t group,
                    engine::Rgb value) {
  for (std::uint32_t r = 0; r < engine::kEstimateReplicates; ++r)
    estimate.interpolated.of_replicate(patch, frame, group, r) = value;
  estimate.interpolated.take_means();
}

}  // namespace tests
