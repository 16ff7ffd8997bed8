#include "engine/image/tone_curve.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

double hable(double x) {
  constexpr double a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

constexpr double kWhite = 11.2;

/// k: where h(k 0.18) / h(11.2) = 0.18, found by bisection; h rises.
double filmic_scale() {
  static const double scale = [] {
    double low = 1, high = 10;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (hable(middle * kMiddleGrey) < kMiddleGrey * hable(kWhite) ? low : high) = middle;
    }
    return low;
  }();
  return scale;
}

}  // namespace

double tone_curve(api::ToneMap tone_map, double exposed) {
  if (tone_map == api::ToneMap::clip) return std::min(exposed, 1.0);
  return std::min(hable(std::min(filmic_scale() * exposed, kWhite)) / hable(kWhite), 1.0);
}

double srgb_encode(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

double tone_curve_white(api::ToneMap tone_map) {
  return tone_map == api::ToneMap::clip ? 1.0 : kWhite / filmic_scale();
}

}  // namespace engine
