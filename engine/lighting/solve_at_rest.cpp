#include "engine/lighting/solve_at_rest.h"

#include "engine/lighting/convergence.h"
#include "engine/lighting/gather.h"

namespace engine {
namespace {

Scale scale_at_rest(const Patches& patches, const RgbValues& values, const std::vector<Rgb>& reflectance) {
  double sum = 0, area = 0, largest = 0, rho = 0;
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    const double value = max_channel(values[patch]);
    sum += patches.area_m2[patch] * value;
    largest = std::max(largest, value);
    rho = std::max(rho, double{max_channel(reflectance[patch])});
    area += patches.area_m2[patch];
  }
  return {sum / area, largest, rho};
}

}  // namespace

api::Result<RestLight> solve_at_rest(const Patches& patches, const TracedLines& lines,
                                     const CoarseExchange& coarse, const std::vector<Rgb>& source_w_m2,
                                     const std::vector<Rgb>& reflectance, const Progress& progress,
                                     double enough) {
  const SampledOperator sampled(lines);
  PatchSeries radiosity(patches.count(), 1);
  radiosity.values.assign(source_w_m2.begin(), source_w_m2.end());
  RestLight light;
  light.irradiance_w_m2.resize(patches.count());
  const auto reflected = [&](PatchId patch) {
    return source_w_m2[patch] + reflectance[patch] * light.irradiance_w_m2[patch];
  };
  ConvergenceTest test(enough);
  for (;;) {
    PatchSeries residual(coarse.group_count(), 1);
    std::vector<float> changes(coarse.group_count());
    const bool went_on = for_each_group(coarse, progress, [&](std::uint32_t group) {
      for (const PatchId patch : coarse.members(group)) {
        sampled.gather_at_rest(radiosity, patch, &light.irradiance_w_m2[patch]);
        const Rgb next = reflected(patch);
        changes[group] = std::max(changes[group], largest_change(radiosity.values[patch], next));
        residual.values[group] += coarse.share(patch) * (next - radiosity.values[patch]);
      }
    });
    if (!went_on) return api::Error{api::Fault::stopped, "stopped while solving the scene at rest"};
    const PatchSeries correction = coarse.correction(residual);
    test.add(changes.empty() ? 0 : *std::max_element(changes.begin(), changes.end()),
             largest_value(correction), scale_at_rest(patches, radiosity.values, reflectance),
             light.convergence);
    if (!std::isfinite(light.convergence.error_left))
      return api::Error{api::Fault::internal, "the light of the scene at rest grew without end"};
    progress.report(test.fraction(light.convergence));
    const bool ends = test.may_end(light.convergence);
    for (std::uint32_t group = 0; group < coarse.group_count(); ++group)
      for (const PatchId patch : coarse.members(group))
        radiosity.values[patch] = reflected(patch) + (ends ? Rgb{} : correction.values[group]);
    if (ends) break;
  }
  light.radiosity_w_m2 = std::move(radiosity.values);
  return light;
}

}  // namespace engine
