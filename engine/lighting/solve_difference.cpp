#include "engine/lighting/solve_difference.h"

#include <numeric>

#include "engine/lighting/convergence.h"

namespace engine {
namespace {

/// M_f R_s, [patch][column]: the same in every iteration.
PatchSeries changes_of_rest(const WindowScene& window, const SampledOperator& sampled,
                            const Columns& columns) {
  PatchSeries changes(window.lit.patches.count(), columns.count());
  for_each_patch(changes.patch_count, {}, [&](PatchId patch) {
    sampled.add_moving(window.rest.radiosity_w_m2, columns, patch, changes.row(patch));
  });
  return changes;
}

/// r <- source + rho D of one patch; answers the largest change of r.
float carry_on(const WindowScene& window, const Columns& columns, PatchId patch, const Rgb* source,
               const Rgb* difference, Rgb* carried) {
  float change = 0;
  for (std::uint32_t c = 0; c < columns.count(); ++c) {
    const Rgb rho = window.lit.reflectance(patch, window.frames[columns.slot(c)]);
    const Rgb next = source[c] + rho * difference[c];
    change = std::max(change, largest_change(carried[c], next));
    carried[c] = next;
  }
  return change;
}

/// Of what lines carry, R_s + r.
Scale scale_of(const WindowScene& window, const Columns& columns, const PatchSeries& r) {
  std::vector<double> sums(r.patch_count), largest(r.patch_count), reflectance(r.patch_count);
  for_each_patch(r.patch_count, {}, [&](PatchId patch) {
    for (std::uint32_t c = 0; c < r.frame_count; ++c) {
      const double carried = max_channel(window.rest.radiosity_w_m2[patch] + r.at(patch, c));
      sums[patch] += carried;
      largest[patch] = std::max(largest[patch], carried);
      const FrameIndex frame = window.frames[columns.slot(c)];
      reflectance[patch] =
          std::max(reflectance[patch], double{max_channel(window.lit.reflectance(patch, frame))});
    }
    sums[patch] *= window.lit.patches.area_m2[patch];
  });
  double area = 0;
  for (const float a : window.lit.patches.area_m2) area += double{a} * r.frame_count;
  return {std::max(0.0, std::accumulate(sums.begin(), sums.end(), 0.0) / area),
          *std::max_element(largest.begin(), largest.end()),
          *std::max_element(reflectance.begin(), reflectance.end())};
}

}  // namespace

PatchSeries source_difference(const WindowScene& window, const Columns& columns) {
  PatchSeries r(window.lit.patches.count(), columns.count());
  for_each_patch(r.patch_count, {}, [&](PatchId patch) {
    const Rgb arriving = window.rest.irradiance_w_m2[patch], rest = window.rest.radiosity_w_m2[patch];
    for (std::uint32_t c = 0; c < columns.count(); ++c) {
      const FrameIndex frame = window.frames[columns.slot(c)];
      r.at(patch, c) = window.source.in_frame(window.lit, patch, frame) +
                       window.lit.reflectance(patch, frame) * arriving - rest;
    }
  });
  return r;
}

api::Result<DifferenceLight> solve_difference(const WindowScene& window, const Columns& columns,
                                              const Progress& progress) {
  const std::uint32_t patches = window.lit.patches.count();
  const SampledOperator sampled(window.lines);
  const PatchSeries source = source_difference(window, columns);
  const PatchSeries of_rest = changes_of_rest(window, sampled, columns);
  const Scale scale = scale_of(window, columns, source);

  DifferenceLight light;
  light.irradiance_w_m2 = PatchSeries(patches, columns.count());
  PatchSeries r = source;
  std::vector<float> changes(patches);
  ConvergenceTest test;
  do {
    const bool went_on = for_each_patch(patches, progress, [&](PatchId patch) {
      Rgb* arriving = light.irradiance_w_m2.row(patch);
      sampled.gather_at_rest(r, patch, arriving);
      for (std::uint32_t c = 0; c < columns.count(); ++c) arriving[c] += of_rest.at(patch, c);
      sampled.add_moving(r, columns, patch, arriving);
    });
    if (!went_on) return api::Error{api::Fault::stopped, "stopped while solving"};
    for_each_patch(patches, {}, [&](PatchId patch) {
      changes[patch] =
          carry_on(window, columns, patch, source.row(patch), light.irradiance_w_m2.row(patch), r.row(patch));
    });
    test.add(*std::max_element(changes.begin(), changes.end()), scale, light.convergence);
    progress.report(test.fraction(light.convergence));
  } while (!test.may_end(light.convergence));
  light.carried_w_m2 = PatchSeries(patches, columns.count());
  for (std::size_t k = 0; k < r.values.size(); ++k) r.values[k] = r.values[k] - source.values[k];
  for_each_patch(patches, {},
                 [&](PatchId patch) { sampled.gather_at_rest(r, patch, light.carried_w_m2.row(patch)); });
  return light;
}

}  // namespace engine
