#include "api/lighting_options.h"

namespace api {

LightingOptions lighting_preset(Preset preset) {
  LightingOptions options;
  options.preset = preset;
  switch (preset) {
    case Preset::draft:
      options.line_count = 500'000;
      options.moving_line_count = 500'000;
      options.samples_per_light = 4;
      options.patch_edge_m = 0.4;
      options.estimate_line_count = 100'000;
      break;
    case Preset::standard:
      break;
    case Preset::high:
      options.line_count = 16'000'000;
      options.moving_line_count = 8'000'000;
      options.samples_per_light = 32;
      options.patch_edge_m = 0.125;
      options.estimate_line_count = 500'000;
      options.tolerance = 0.02;
      break;
  }
  return options;
}

}  // namespace api
