// How bright light is shown. Apart from the pictures, for those who show radiosity without them.
#pragma once

#include "api/image_options.h"

namespace engine {

/// The reflectance of the photographer's grey card: what exposure brings a sequence's mean to.
inline constexpr double kMiddleGrey = 0.18;

/// Exposed radiance (>= 0) -> display light, 0 .. 1. Both show 0.18 as 0.18.
///   clip:   min(x, 1).
///   filmic: h(k x) / h(11.2), h(x) = (x (A x + C B) + D E) / (x (A x + B) + D F) - E / F with A .15, B .50,
///           C .10, D .20, E .02, F .30, limited to 1; white is reached at k x = 11.2. k is such that middle
///           grey stays. Per channel, so bright saturated colours turn towards white.
///           Source: J. Hable, "Uncharted 2: HDR Lighting", Game Developers Conference 2010.
double tone_curve(api::ToneMap tone_map, double exposed);

/// Display light 0 .. 1 -> sRGB value 0 .. 1. Source: IEC 61966-2-1.
double srgb_encode(double light);

/// The least exposed radiance that is shown as 1.
double tone_curve_white(api::ToneMap tone_map);

}  // namespace engine
