// Radiance -> what a screen shows: exposure, tone curve, sRGB.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "api/image_options.h"
#include "engine/animation/animation.h"
#include "engine/base/rgb.h"
#include "engine/image/tone_curve.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"

namespace engine {

/// The factor on radiance that shows a sequence's mean in middle grey, the same for all of its frames:
///
///     factor = 0.18 pi / mean B            mean B = sum A_i Y(B_if) / sum A_i        [W/m^2]
///
/// over all frames f and all patches i that emit in no frame; Y = 0.2126 R + 0.7152 G + 0.0722 B, the
/// luminance of Rec. 709. 0.18 is the reflectance of the photographer's grey card. 1 where all is dark.
double auto_exposure_factor(const Patches& patches, const Animation& animation,
                            const PatchSeries& radiosity_w_m2);

/// Radiance -> 8 bits per channel: round(255 srgb_encode(tone_curve(factor x radiance))), from a table that
/// deviates by less than 1e-4 of full scale. Negative and NaN radiance is black.
class DisplayTable {
 public:
  DisplayTable(api::ToneMap tone_map, double exposure_factor);
  std::uint8_t operator()(float radiance) const;

  /// The same of each; `shown` has the size of `radiance`.
  void show(std::span<const float> radiance, std::uint8_t* shown) const;

  /// From here up everything is shown as 255. Light that is limited to it before pixels are filtered looks
  /// the same, but the edges of lamps get shades between lamp and background instead of steps.
  float white_radiance() const { return white_radiance_; }

 private:
  float factor_, white_radiance_;
  std::vector<float> encoded_;  ///< 0 .. 255 at the table's points, the last one twice; see the .cpp
};

}  // namespace engine
