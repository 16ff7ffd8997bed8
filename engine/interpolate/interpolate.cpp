#include "engine/interpolate/interpolate.h"

#include <algorithm>

#include "engine/base/parallel.h"

namespace engine {
namespace {

constexpr std::uint32_t kPatchesPerTask = 1024;

}  // namespace

Between between(std::span<const api::FrameIndex> solved, api::FrameIndex frame) {
  const auto after = std::lower_bound(solved.begin(), solved.end(), frame);
  if (after == solved.end()) {
    const auto last = static_cast<std::uint32_t>(solved.size() - 1);
    return {last, last, 0};
  }
  const auto position = static_cast<std::uint32_t>(after - solved.begin());
  if (*after == frame || position == 0) return {position, position, 0};
  const float weight = static_cast<float>(frame - solved[position - 1]) /
                       static_cast<float>(solved[position] - solved[position - 1]);
  return {position - 1, position, weight};
}

PatchSeries interpolate_linear(const PatchSeries& at_solved, std::span<const api::FrameIndex> solved,
                               std::uint32_t frame_count) {
  PatchSeries all(at_solved.patch_count, frame_count);
  std::vector<Between> where(frame_count);
  for (std::uint32_t frame = 0; frame < frame_count; ++frame) where[frame] = between(solved, frame);
  parallel_for((all.patch_count + kPatchesPerTask - 1) / kPatchesPerTask, [&](std::size_t task) {
    const PatchId first = static_cast<PatchId>(task) * kPatchesPerTask;
    for (PatchId patch = first; patch < std::min(first + kPatchesPerTask, all.patch_count); ++patch) {
      const Rgb* known = at_solved.row(patch);
      Rgb* row = all.row(patch);
      for (std::uint32_t frame = 0; frame < frame_count; ++frame) {
        const Between& at = where[frame];
        row[frame] = known[at.before] * (1.0f - at.weight) + known[at.after] * at.weight;
      }
    }
  });
  return all;
}

}  // namespace engine
