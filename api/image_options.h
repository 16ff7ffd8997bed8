// Images a job asks for. JSON: api/schemas/job.schema.json#/$defs/image.
#pragma once

#include <cstdint>
#include <string>

namespace api {

enum class ToneMap {
  clip,    ///< radiance times exposure, clipped to 1
  filmic,  ///< a filmic shoulder (Hable): bright light rolls off instead of clipping
};

/// One camera's pictures of every frame, in `artefacts/images/<camera>/`.
struct ImageOptions {
  std::string camera;          ///< name of a camera of the scene
  std::uint32_t width = 640;   ///< [pixels] 1 .. 8192
  std::uint32_t height = 360;  ///< [pixels] 1 .. 8192
  bool png = true;             ///< tone-mapped, sRGB, 8 bits
  bool exr = false;            ///< linear radiance, half floats  [W sr^-1 m^-2]
  bool jpg = false;            ///< the same as JPEG of quality 90, colours at full resolution
  /// PNG and JPEG only: radiance is multiplied by 2^exposure_stops. Not given in the JSON: chosen once for
  /// the whole sequence from its mean radiosity, so that it does not flicker.  -32 .. 32
  double exposure_stops = 0;
  bool auto_exposure = true;
  ToneMap tone_map = ToneMap::filmic;
  std::uint32_t samples_per_pixel = 4;  ///< 1 .. 64

  friend bool operator==(const ImageOptions&, const ImageOptions&) = default;
};

}  // namespace api
