#include <array>

#include "engine/interpolate/interpolate.h"
#include "engine/lighting/carried_rows.h"
#include "engine/lighting/solve_difference.h"

namespace engine {
namespace {

/// Two moving patches that face each other exchange most of their light: after two sweeps up to a tenth of it
/// was still that of other frames.
constexpr int kSweeps = 4;

/// T_s s_f + Y_f, [patch][slot]: what no sweep changes.
PatchSeries carried_in_every_slot(const WindowScene& window, const Columns& all,
                                  const PatchSeries& at_columns, const Interpolator& interpolator) {
  const SampledOperator at_rest(window.transport.lines);
  const PatchSeries source = source_difference(window, all);
  PatchSeries carried(source.patch_count, source.frame_count);
  for_each_patch(carried.patch_count, {}, [&](PatchId patch) {
    std::array<Rgb, kWindowMax> reflected;
    interpolator.apply(at_columns.row(patch), reflected.data());
    Rgb* row = carried.row(patch);
    at_rest.gather_at_rest(source, patch, row);
    for (std::uint32_t slot = 0; slot < all.count(); ++slot) row[slot] += reflected[slot];
  });
  return carried;
}

}  // namespace

api::Result<PatchSeries> fill_between(const WindowScene& window, const Columns& columns,
                                      const DifferenceLight& solved, api::Interpolation interpolation,
                                      const Progress& progress) {
  if (columns.count() == window.frames.size()) return PatchSeries(solved.irradiance_w_m2);
  std::vector<FrameIndex> knots;
  for (const std::uint32_t slot : columns.slots()) knots.push_back(window.frames[slot]);
  const Interpolator interpolator(knots, window.frames, interpolation);
  PatchSeries difference = interpolate(solved.irradiance_w_m2, interpolator);

  const Columns all = Columns::every(static_cast<std::uint32_t>(window.frames.size()));
  const SampledOperator sampled(window.lines);
  const PatchSeries carried = carried_in_every_slot(window, all, solved.carried_w_m2, interpolator);
  const CarriedRows rows(window.lit, window.source, window.rest,
                         {window.frames.begin(), window.frames.end()});
  PatchSeries radiosity(difference.patch_count, difference.frame_count);  // R_s + r: all that lines carry
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    // What no moving object changes is as it was after the first sweep.
    const auto is_done = [&](PatchId patch) {
      return sweep > 1 && window.lines.moving_rows.row(patch).empty();
    };
    for_each_patch(radiosity.patch_count, {}, [&](PatchId patch) {
      if (is_done(patch)) return;
      rows.radiosity(patch, difference.row(patch), radiosity.row(patch));
    });
    const bool went_on = for_each_patch(radiosity.patch_count, progress, [&](PatchId patch) {
      if (is_done(patch)) return;
      Rgb* row = difference.row(patch);
      std::copy_n(carried.row(patch), all.count(), row);
      sampled.add_moving(radiosity, all, patch, row);
    });
    if (!went_on) return api::Error{api::Fault::stopped, "stopped while filling the frames between"};
    progress.report((sweep + 1.0) / kSweeps);
  }
  return difference;
}

}  // namespace engine
