#include <numeric>

#include "engine/interpolate/interpolate.h"
#include "engine/lighting/solve_difference.h"

namespace engine {
namespace {

constexpr int kSweeps = 2;

Columns every_slot(std::size_t slots) {
  std::vector<std::uint32_t> all(slots);
  std::iota(all.begin(), all.end(), 0u);
  return {std::move(all), static_cast<std::uint32_t>(slots)};
}

}  // namespace

api::Result<PatchSeries> fill_between(const WindowScene& window, const Columns& columns,
                                      const DifferenceLight& solved, api::Interpolation interpolation,
                                      const Progress& progress) {
  if (columns.count() == window.frames.size()) return PatchSeries(solved.irradiance_w_m2);
  std::vector<FrameIndex> knots;
  for (const std::uint32_t slot : columns.slots()) knots.push_back(window.frames[slot]);
  const Interpolator interpolator(knots, window.frames, interpolation);
  const PatchSeries carried = interpolate(solved.carried_w_m2, interpolator);
  PatchSeries difference = interpolate(solved.irradiance_w_m2, interpolator);

  const Columns all = every_slot(window.frames.size());
  const SampledOperator sampled(window.lines);
  const PatchSeries source = source_difference(window, all);
  PatchSeries r(source.patch_count, source.frame_count);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for_each_patch(r.patch_count, {}, [&](PatchId patch) {
      for (std::uint32_t slot = 0; slot < all.count(); ++slot)
        r.at(patch, slot) = source.at(patch, slot) + window.rest.radiosity_w_m2[patch] +
                            window.lit.reflectance(patch, window.frames[slot]) * difference.at(patch, slot);
    });
    const bool went_on = for_each_patch(r.patch_count, progress, [&](PatchId patch) {
      Rgb* row = difference.row(patch);
      std::copy_n(carried.row(patch), all.count(), row);
      sampled.add_moving(r, all, patch, row);
      for (std::uint32_t c = 0; c < columns.count(); ++c)
        row[columns.slot(c)] = solved.irradiance_w_m2.at(patch, c);
    });
    if (!went_on) return api::Error{api::Fault::stopped, "stopped while filling the frames between"};
  }
  return difference;
}

}  // namespace engine
