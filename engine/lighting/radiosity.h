// A light quantity of many patches in many frames.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/large_pages.h"
#include "engine/base/rgb.h"
#include "engine/patches/patches.h"

namespace engine {

using RgbValues = std::vector<Rgb, ZeroedLargePages<Rgb>>;

/// One Rgb per patch and frame (or key-frame, or slot), the frames of a patch side by side: radiosity, the
/// irradiance that arrives, or what of it is reflected; the name of the variable says which.  [W/m^2]
struct PatchSeries {
  std::uint32_t patch_count = 0;
  std::uint32_t frame_count = 0;
  RgbValues values;  ///< [patch][frame]

  PatchSeries() = default;
  PatchSeries(std::uint32_t patches, std::uint32_t frames)
      : patch_count(patches), frame_count(frames), values(std::size_t{patches} * frames) {}
  Rgb* row(PatchId patch) { return values.data() + std::size_t{patch} * frame_count; }
  const Rgb* row(PatchId patch) const { return values.data() + std::size_t{patch} * frame_count; }
  Rgb& at(PatchId patch, std::uint32_t frame) { return row(patch)[frame]; }
  const Rgb& at(PatchId patch, std::uint32_t frame) const { return row(patch)[frame]; }
};

/// sum += part, which has the same patches and frames.
inline void add(const PatchSeries& part, PatchSeries& sum) {
  for (std::size_t k = 0; k < sum.values.size(); ++k) sum.values[k] += part.values[k];
}

}  // namespace engine
