#include "engine/lighting/solve_lighting.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"

namespace engine {
namespace {

constexpr std::uint32_t kIterationsMax = 500;
constexpr double kChangeMax = 1e-5;  ///< of B in one iteration, relative to the mean source
constexpr std::uint32_t kRowsPerTask = 1024;

/// Area-weighted mean over patches and slots of the largest channel.
double mean_of(const Patches& patches, const PatchSeries& series) {
  double sum = 0, area = 0;
  for (PatchId patch = 0; patch < patches.count(); ++patch)
    for (std::uint32_t slot = 0; slot < series.frame_count; ++slot) {
      sum += double{patches.area_m2[patch]} * max_channel(series.at(patch, slot));
      area += patches.area_m2[patch];
    }
  return area > 0 ? sum / area : 0;
}

float largest_change(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// B <- S + rho H; the largest change of B.
float update(const std::vector<Rgb>& reflectance, const PatchSeries& source, const PatchSeries& irradiance,
             PatchSeries& radiosity) {
  const std::uint32_t count = source.patch_count;
  std::vector<float> changes((count + kRowsPerTask - 1) / kRowsPerTask, 0.0f);
  parallel_for(changes.size(), [&](std::size_t task) {
    const PatchId first = static_cast<PatchId>(task) * kRowsPerTask;
    for (PatchId patch = first; patch < std::min(first + kRowsPerTask, count); ++patch)
      for (std::uint32_t slot = 0; slot < source.frame_count; ++slot) {
        const Rgb next = source.at(patch, slot) + reflectance[patch] * irradiance.at(patch, slot);
        changes[task] = std::max(changes[task], largest_change(next, radiosity.at(patch, slot)));
        radiosity.at(patch, slot) = next;
      }
  });
  return *std::max_element(changes.begin(), changes.end());
}

}  // namespace

api::Result<Solution> solve_lighting(const Patches& patches, const TracedLines& lines,
                                     const std::vector<Rgb>& reflectance, const PatchSeries& source_w_m2,
                                     const Progress& progress) {
  const SampledOperator sampled(patches, lines);
  Solution solution;
  solution.empty_rows = sampled.empty_rows().size();
  solution.irradiance_w_m2 = PatchSeries(patches.count(), lines.slot_count);
  const double mean = mean_of(patches, source_w_m2);
  if (mean == 0) return solution;  // no light at all

  PatchSeries radiosity = source_w_m2;
  double first_change = 0;
  do {
    if (!sampled.apply(radiosity, solution.irradiance_w_m2, progress))
      return api::Error{api::Fault::stopped, "stopped while solving"};
    solution.last_change = update(reflectance, source_w_m2, solution.irradiance_w_m2, radiosity) / mean;
    if (++solution.iterations == 1) first_change = solution.last_change;
    // The change shrinks by about the same factor each time, so its logarithm measures the way.
    if (solution.last_change > kChangeMax && first_change > kChangeMax)
      progress.report(std::log(first_change / solution.last_change) / std::log(first_change / kChangeMax));
  } while (solution.last_change > kChangeMax && solution.iterations < kIterationsMax);
  progress.report(1.0);
  return solution;
}

}  // namespace engine
