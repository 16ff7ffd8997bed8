#include "engine/lighting/solve_at_rest.h"

#include "engine/lighting/convergence.h"
#include "engine/lighting/gather.h"

namespace engine {
namespace {

Scale scale_of(const Patches& patches, const std::vector<Rgb>& values, const std::vector<Rgb>& reflectance) {
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
                                     const std::vector<Rgb>& source_w_m2, const std::vector<Rgb>& reflectance,
                                     const Progress& progress) {
  const SampledOperator sampled(lines);
  PatchSeries radiosity(patches.count(), 1);
  radiosity.values = source_w_m2;
  RestLight light;
  light.irradiance_w_m2.resize(patches.count());
  std::vector<float> changes(patches.count());
  ConvergenceTest test;
  do {
    const bool went_on = for_each_patch(patches.count(), progress, [&](PatchId patch) {
      sampled.gather_at_rest(radiosity, patch, &light.irradiance_w_m2[patch]);
    });
    if (!went_on) return api::Error{api::Fault::stopped, "stopped while solving the scene at rest"};
    for_each_patch(patches.count(), {}, [&](PatchId patch) {
      const Rgb next = source_w_m2[patch] + reflectance[patch] * light.irradiance_w_m2[patch];
      changes[patch] = largest_change(radiosity.values[patch], next);
      radiosity.values[patch] = next;
    });
    test.add(*std::max_element(changes.begin(), changes.end()),
             scale_of(patches, radiosity.values, reflectance), light.convergence);
    progress.report(test.fraction(light.convergence));
  } while (!test.may_end(light.convergence));
  light.radiosity_w_m2 = std::move(radiosity.values);
  return light;
}

}  // namespace engine
