#include "engine/lighting/sources.h"

#include <cmath>
#include <numbers>

#include "engine/animation/light_groups.h"
#include "engine/base/sobol.h"
#include "engine/lighting/gather.h"

namespace engine {

namespace {

/// Two uniform numbers to a standard normal one. Source: Box & Muller, Ann. Math. Stat. 29(2), 1958.
float normal(std::uint64_t stream) {
  const double u = (static_cast<double>(stream >> 40) + 0.5) * 0x1p-24;
  const double v = static_cast<double>(stream & 0xffffff) * 0x1p-24;
  return static_cast<float>(std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v));
}

}  // namespace

std::vector<float> noise_of_direct(const DirectLight& direct, std::uint32_t replicate,
                                   std::uint32_t replicates, std::uint64_t seed, std::size_t group) {
  if (direct.variance.values.empty() || replicates < 2) return {};
  constexpr std::uint64_t kStream = 0x6e6f697365ull;
  const std::uint32_t block = replicate / replicates;
  const std::uint64_t of_block = stream_seed(stream_seed(seed, kStream + group), block);
  const auto count = static_cast<float>(replicates);
  const float growth = (static_cast<float>(2 * block + 1) * count - 1) / (count - 1);
  const float spread = std::sqrt(count * growth);
  std::vector<float> noise(direct.variance.patch_count);
  for_each_patch(direct.variance.patch_count, {}, [&](PatchId patch) {
    const std::uint64_t stream = stream_seed(of_block, patch);
    float mean = 0;
    for (std::uint32_t r = 0; r < replicates; ++r) mean += normal(stream_seed(stream, r));
    mean /= static_cast<float>(replicates);
    noise[patch] = spread * (normal(stream_seed(stream, replicate % replicates)) - mean);
  });
  return noise;
}

Rgb GroupSource::in_frame(const LitScene& lit, PatchId patch, FrameIndex frame) const {
  if (!direct) return lit.exitance(*emission, patch, frame);
  Rgb arriving = direct_in_frame(patch, frame);
  if (!noise.empty()) {
    const Rgb variance = direct->variance.at(patch, column(frame));
    arriving += noise[patch] * Rgb{std::sqrt(variance.r), std::sqrt(variance.g), std::sqrt(variance.b)};
  }
  return lit.reflectance(patch, frame) * arriving;
}

std::vector<Rgb> source_at_rest(const LitScene& lit, const GroupSource& source,
                                std::span<const Rgb> reflectance_at_rest) {
  std::vector<Rgb> at_rest(lit.patches.count());
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (!lit.at_rest(patch)) continue;
    if (source.direct)
      // A scene of one frame is all at rest: its noise has no other place.
      at_rest[patch] = lit.animation.frame_count == 1
                           ? source.in_frame(lit, patch, 0)
                           : reflectance_at_rest[patch] * source.direct->at_rest_w_m2[patch];
    else if (!lit.patches.is_back(patch))
      at_rest[patch] = mean_exitance(*source.emission, lit.material_of(patch));
  }
  return at_rest;
}

}  // namespace engine
