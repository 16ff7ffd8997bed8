// What an estimate consists of.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/lighting/compose.h"

namespace engine {

/// Independent sets of lines, to tell light from noise.
inline constexpr std::uint32_t kEstimateReplicates = 8;

/// A quantity of several groups in every replicate. What is compared lies side by side.
struct ReplicateSeries {
  static constexpr std::size_t kOfGroup = 1 + kEstimateReplicates;  ///< mean, then replicates

  std::uint32_t patch_count = 0, frame_count = 0, group_count = 0;
  RgbValues values;  ///< [patch][frame][group][mean, then replicates]

  ReplicateSeries() = default;
  ReplicateSeries(std::uint32_t patches, std::uint32_t frames, std::uint32_t groups)
      : patch_count(patches),
        frame_count(frames),
        group_count(groups),
        values(std::size_t{patches} * frames * groups * kOfGroup) {}

  /// [group][mean, then replicates]
  const Rgb* at(PatchId patch, std::uint32_t frame) const {
    return values.data() + (std::size_t{patch} * frame_count + frame) * group_count * kOfGroup;
  }
  Rgb& of_replicate(PatchId patch, std::uint32_t frame, std::uint32_t group, std::uint32_t replicate) {
    return values[(std::size_t{patch} * frame_count + frame) * group_count * kOfGroup + group * kOfGroup + 1 +
                  replicate];
  }
  /// Makes all means those of the replicates.
  void take_means() {
    for (std::size_t k = 0; k < values.size(); k += kOfGroup) {
      values[k] = {};
      for (std::uint32_t r = 1; r < kOfGroup; ++r) values[k] += values[k + r] * (1.0f / kEstimateReplicates);
    }
  }
};

/// Lighting of every frame on large patches.
struct Estimate {
  Patches patches;
  std::vector<LitGroup> groups;  ///< as handed in, with their direct light
  PatchSeries radiosity_w_m2;  ///< B, [patch][frame]; 0 where the object is not there; mean of the replicates
  /// Mode `default`: what interpolation would be applied to: Y of solve_difference, of each group before its
  /// scale; or, where all light is interpolated, B itself in one group. Empty in the other modes.  [W/m^2]
  ReplicateSeries interpolated;
  std::uint64_t line_count = 0;  ///< that all of it is of; all replicates together
};

}  // namespace engine
