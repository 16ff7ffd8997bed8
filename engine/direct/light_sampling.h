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

std::vector<Light> find_lights(const Patches& patches, const Emission& emission);

/// A light where its object puts it.
struct PlacedLight {
  PlacedFacet placed;
  bool is_triangle = false;
  std::array<Vec3, 4> corners;  ///< 3 of them for a triangle

  std::span<const Vec3> polygon() const { return {corners.data(), is_triangle ? 3u : 4u}; }
};

PlacedLight place_light(const Facet& facet, const PlacedFacet& placed);

/// A point of the light for a shadow ray from `point`, with a density in proportion to what each point of it
/// contributes, cos cos / r^2: then the form factor times what the rays see is right whatever hides part of
/// the light, and without noise where nothing does. A light that is near is halved, and one half chosen in
/// proportion to its form factor, until what is left is far for its size (or 16 times); from that a point is
/// drawn by area until one is accepted (rejection, 16 draws at most; fewer than 2 in the mean).
/// a, b, c: uniform in [0, 1), the chosen point is a function of them alone: c chooses the piece, a and b the
/// point on it.
/// Why form factors and not a few candidates: they are exact, so each piece gets its share; with 16
/// candidates half-hidden walls that emit were off by 3 %. Precondition: some of the light is above the
/// receiver's horizon and the receiver in front of the light.
Vec3 sample_light(const PlacedLight& light, Vec3 point, Vec3 normal, float a, float b, float c);

}  // namespace engine
