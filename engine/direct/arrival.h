// What a point of a patch gets from a light, and along which ray.
#pragma once

#include "engine/direct/receiver.h"

namespace engine {

/// Numbers that choose the points of one shadow ray, each uniform in [0, 1).
struct Draw {
  float on_patch_a = 0, on_patch_b = 0;
  float on_light_a = 0, on_light_b = 0;
  float piece = 0;  ///< of the light, see sample_light
};

/// Without occluders; times the light's brightness it is irradiance.
struct Arrival {
  float factor = 0;  ///< facets, directional [-]; point, spot [1/m^2]; 0: there is no ray
  Ray shadow;        ///< from 0 to 1, a hair off the surfaces at its ends
};

/// The largest share of a spot's intensity that reaches any point of a ball whose middle is at `apart` from
/// it.
float largest_spot_share(const SourceMotion& spot, Vec3 direction, Vec3 apart, float radius_m);

/// Points of a patch against one light. The patch and the light outlive it.
///
///     facet         F(x), the closed form factor; the ray ends at a point of it (sample_light)
///     point         cos / r^2
///     spot          cos / r^2  (3 t^2 - 2 t^3),  t = (c - c_outer) / (c_inner - c_outer), held to 0 .. 1
///     directional   cos; the ray is `reach_m` long
///
/// cos: between the patch's normal and the way to the light, 0 behind it. c: cosine between the spot's axis
/// and the way to the point. Source of the falloff: api::LightSource.
class Arrivals {
 public:
  /// `reach_m`: no two points of the scene are further apart, in any frame.
  Arrivals(const Receiver& receiver, const LightPose& light, float reach_m);

  /// False where no point of the patch's facet can get any.
  bool possible() const;
  Arrival draw(const Draw& numbers) const;

 private:
  Arrival from_facet(Vec3 on_patch, const Draw& numbers) const;
  Arrival from_source(Vec3 on_patch) const;

  const Receiver& receiver_;
  const LightPose& light_;
  const float reach_m_,
      gap_m_;  ///< `gap_m_`: how far rays end before a point light, which may lie on a surface
  const Vec3 off_patch_, off_light_;
};

}  // namespace engine
