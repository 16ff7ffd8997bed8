// Emitting facets, and points on them that matter to a receiver.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/patches/placed_facet.h"

namespace engine {

/// A facet whose material emits in some frame. It shines from its front.
struct Light {
  std::uint32_t facet = 0;
};

std::vector<Light> find_lights(const Patches& patches, const Animation& animation);

/// A light where its object puts it.
struct PlacedLight {
  PlacedFacet placed;
  bool is_triangle = false;
  std::array<Vec3, 4> corners;  ///< 3 of them for a triangle
  float diameter_m = 0;

  std::span<const Vec3> polygon() const { return {corners.data(), is_triangle ? 3u : 4u}; }
};

PlacedLight place_light(const Facet& facet, const PlacedFacet& placed);

/// A point of the light for a shadow ray from `point`, chosen with a density close to what each point of it
/// contributes, cos cos / r^2: far lights uniformly by area, near ones by choosing among 16 stratified
/// candidates in proportion to their contribution (resampled importance sampling).
/// a, b, c: uniform in [0, 1), the chosen point is a function of them alone.
/// Precondition: some of the light is above the receiver's horizon and the receiver in front of the light.
/// Source: Talbot, Cline & Egbert, "Importance resampling for global illumination", EGSR 2005.
Vec3 sample_light(const PlacedLight& light, Vec3 point, Vec3 normal, float a, float b, float c);

}  // namespace engine
