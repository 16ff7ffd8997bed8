#include "engine/lighting/solve_lighting.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"

namespace engine {
namespace {

constexpr std::uint32_t kRowsPerTask = 1024;

/// What one iteration did to B.
struct Step {
  float largest = 0;  ///< change of a channel  [W/m^2]
  double sum = 0;     ///< over patches and slots: area times largest channel  [W]
};

/// Changes within the rounding of the value itself would go on for ever.
float change(float before, float after) {
  constexpr float kRounding = 2.4e-7f;  // two units in the last place
  const float by = std::abs(after - before);
  return by > kRounding * std::abs(after) ? by : 0.0f;
}

/// B <- S + rho H for the rows of one task.
Step update_rows(PatchId first, PatchId end, const Patches& patches, const std::vector<Rgb>& reflectance,
                 const PatchSeries& source, const PatchSeries& irradiance, PatchSeries& radiosity) {
  Step step;
  for (PatchId patch = first; patch < end; ++patch)
    for (std::uint32_t slot = 0; slot < source.frame_count; ++slot) {
      Rgb& value = radiosity.at(patch, slot);
      const Rgb next = source.at(patch, slot) + reflectance[patch] * irradiance.at(patch, slot);
      step.largest =
          std::max({step.largest, change(value.r, next.r), change(value.g, next.g), change(value.b, next.b)});
      step.sum += double{patches.area_m2[patch]} * max_channel(next);
      value = next;
    }
  return step;
}

Step update(const Patches& patches, const std::vector<Rgb>& reflectance, const PatchSeries& source,
            const PatchSeries& irradiance, PatchSeries& radiosity) {
  const std::uint32_t count = source.patch_count;
  std::vector<Step> steps((count + kRowsPerTask - 1) / kRowsPerTask);
  parallel_for(steps.size(), [&](std::size_t task) {
    const PatchId first = static_cast<PatchId>(task) * kRowsPerTask;
    steps[task] = update_rows(first, std::min(first + kRowsPerTask, count), patches, reflectance, source,
                              irradiance, radiosity);
  });
  Step whole;
  for (const Step& step : steps) {
    whole.largest = std::max(whole.largest, step.largest);
    whole.sum += step.sum;
  }
  return whole;
}

bool is_dark(const PatchSeries& source) {
  return std::all_of(source.values.begin(), source.values.end(), [](Rgb s) { return max_channel(s) <= 0; });
}

/// Bound on the changes to come, when the last one was `change` and the one before it `before`.
double changes_to_come(double change, double before) {
  const double ratio = before > 0 ? std::min(change / before, 0.9999) : 0.9999;
  return change * ratio / (1 - ratio);
}

}  // namespace

api::Result<Solution> solve_lighting(const Patches& patches, const TracedLines& lines,
                                     const std::vector<Rgb>& reflectance, const PatchSeries& source_w_m2,
                                     const Progress& progress) {
  const SampledOperator sampled(patches, lines);
  Solution solution;
  solution.empty_rows = sampled.empty_rows().size();
  solution.irradiance_w_m2 = PatchSeries(patches.count(), lines.slot_count);
  if (is_dark(source_w_m2)) return solution;

  double area_m2 = 0;
  for (const float area : patches.area_m2) area_m2 += double{area} * lines.slot_count;
  PatchSeries radiosity = source_w_m2;
  double last_change = 0, first_error = 0;
  do {
    if (!sampled.apply(radiosity, solution.irradiance_w_m2, progress))
      return api::Error{api::Fault::stopped, "stopped while solving"};
    const Step step = update(patches, reflectance, source_w_m2, solution.irradiance_w_m2, radiosity);
    solution.error_left = changes_to_come(step.largest, last_change) * area_m2 / step.sum;
    solution.converged = solution.error_left <= kIterationError;
    last_change = step.largest;
    if (++solution.iterations == 2) first_error = solution.error_left;
    // The error shrinks by about the same factor each time, so its logarithm measures the way.
    if (!solution.converged && first_error > kIterationError)
      progress.report(std::max(
          0.0, std::log(first_error / solution.error_left) / std::log(first_error / kIterationError)));
  } while (!solution.converged && solution.iterations < kIterationsMax);
  progress.report(1.0);
  return solution;
}

}  // namespace engine
