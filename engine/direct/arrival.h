// What a point of a patch gets from a light, and along which ray.
#pragma once

#include "engine/direct/receiver.h"

namespace engine {

/// Numbers that choose the point of a light, each uniform in [0, 1); see sample_light.
struct LightDraw {
  float a = 0, b = 0, piece = 0;
};

/// The largest share of a spot's intensity that reaches any point of a ball whose middle is at `apart` from
/// it.
float largest_spot_share(const SourceMotion& spot, Vec3 direction, Vec3 apart, float radius_m);

/// Points of a patch against one light. The patch and the light outlive it.
///
/// Without occluders, times the light's brightness it is irradiance; facets, directional [-], point, spot
/// [1/m^2]:
///
///     facet         F(x), the closed form factor (PolygonOverPlane); the ray ends at a point of it
///                   (sample_light)
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
  /// Of a light without surface; 0 where none of it can arrive.
  float source_factor(Vec3 on_patch) const;
  /// From 0 to 1, a hair off the surfaces at its ends. `on_patch`: a point that gets some of the light.
  Ray shadow(Vec3 on_patch, const LightDraw& numbers) const;

 private:
  const Receiver& receiver_;
  const LightPose& light_;
  const float reach_m_;
  const float gap_m_;  ///< how far rays end before a point light, which may lie on a surface
  const Vec3 off_patch_, off_light_;
};

}  // namespace engine
