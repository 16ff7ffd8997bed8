#include "engine/direct/light_sampling.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/base/sobol.h"
#include "engine/direct/form_factor.h"

namespace engine {
namespace {

/// Beyond this many diameters a piece of a light is halved no more: what its points contribute differs by a
/// factor of 4 at most, and drawing again until one is accepted takes fewer than 2 draws in the mean.
constexpr float kFarDiameters = 3.0f;

/// Halvings of a light: bounds the work where a point almost touches it.
constexpr int kHalvingsMax = 16;

/// Draws on a piece; the last one is taken as it is.
constexpr int kDrawsMax = 16;

/// A light or a piece of it.
struct Piece {
  Vec3 origin, edge_u, edge_v;
  bool is_triangle = false;

  /// Uniform by area. Triangles: the square folded over its diagonal.
  Vec3 at(float u, float v) const {
    if (is_triangle && u + v > 1.0f) {
      u = 1.0f - u;
      v = 1.0f - v;
    }
    return origin + u * edge_u + v * edge_v;
  }

  Vec3 middle() const { return origin + (is_triangle ? 1.0f / 3.0f : 0.5f) * (edge_u + edge_v); }

  float diameter_m() const {
    if (is_triangle) return std::max({length(edge_u), length(edge_v), length(edge_u - edge_v)});
    return std::max(length(edge_u + edge_v), length(edge_u - edge_v));
  }

  float form_factor(Vec3 point, Vec3 normal) const {
    const Vec3 corners[4] = {origin, origin + edge_u,
                             is_triangle ? origin + edge_v : origin + edge_u + edge_v, origin + edge_v};
    return point_to_polygon_form_factor(point, normal, {corners, is_triangle ? 3u : 4u});
  }

  /// Across the longest edge.
  std::pair<Piece, Piece> halves() const {
    const float u = length(edge_u), v = length(edge_v);
    if (is_triangle && length(edge_v - edge_u) > std::max(u, v)) {
      const Vec3 half = 0.5f * (edge_u + edge_v);
      return {{origin, edge_u, half, true}, {origin, half, edge_v, true}};
    }
    if (u >= v) {
      const Vec3 half = 0.5f * edge_u;
      return {{origin, half, edge_v, is_triangle},
              {origin + half, half, is_triangle ? edge_v - half : edge_v, is_triangle}};
    }
    const Vec3 half = 0.5f * edge_v;
    return {{origin, edge_u, half, is_triangle},
            {origin + half, is_triangle ? edge_u - half : edge_u, half, is_triangle}};
  }

  /// Far for its size, and above the horizon.
  bool is_far(Vec3 point, Vec3 normal) const {
    const float diameter = diameter_m(), far = kFarDiameters * diameter;
    const Vec3 apart = middle() - point;
    return dot(apart, apart) > far * far && dot(normal, apart) > 0.5f * diameter;
  }
};

/// A number in [0, 1) from the upper bits of `bits`.
float unit_float(std::uint64_t bits) {
  return static_cast<float>(bits >> 40) * 0x1p-24f;
}

/// Of a point of a plane light as seen from a receiver's: cos cos / r^2 but for a factor that all its points
/// share.
struct Contribution {
  Vec3 point, normal;
  float operator()(Vec3 on_light) const {
    const Vec3 apart = on_light - point;
    const float squared = dot(apart, apart);
    return std::max(0.0f, dot(normal, apart)) / (squared * squared);
  }
  /// No point of the piece contributes more.
  float bound(const Piece& piece, float over_light) const {
    const Vec3 apart = piece.middle() - point;
    const float radius = (piece.is_triangle ? 0.67f : 0.5f) * piece.diameter_m();
    const float height = dot(normal, apart) + radius;
    const float near = std::max(over_light, length(apart) - radius);
    return height / (near * near * near * near);
  }
};

/// A point of the piece with a density in proportion to its contribution (rejection).
Vec3 point_of(const Piece& piece, const Contribution& contribution, float bound, float a, float b, float c) {
  std::uint64_t random =
      mix(std::bit_cast<std::uint32_t>(a) ^ (std::uint64_t{std::bit_cast<std::uint32_t>(b)} << 32) ^
          (std::uint64_t{std::bit_cast<std::uint32_t>(c)} * 0x9e3779b97f4a7c15ull));
  for (int draw = 1;; ++draw) {
    const Vec3 at = piece.at(a, b);
    if (draw == kDrawsMax || unit_float(random) * bound < contribution(at)) return at;
    a = unit_float(mix(random + 1));
    b = unit_float(mix(random + 2));
    random = mix(random + 3);
  }
}

}  // namespace

std::vector<Light> find_lights(const Patches& patches, const Emission& emission) {
  std::vector<Light> lights;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f)
    if (emission.ever_emits(patches.facets[f].material)) lights.push_back({f});
  return lights;
}

PlacedLight place_light(const Facet& facet, const PlacedFacet& placed) {
  PlacedLight light;
  light.placed = placed;
  light.is_triangle = facet.is_triangle;
  const Vec3 o = placed.origin, u = placed.edge_u, v = placed.edge_v;
  if (facet.is_triangle)
    light.corners = {o, o + u, o + v, o};
  else
    light.corners = {o, o + u, o + u + v, o + v};
  return light;
}

Vec3 sample_light(const PlacedLight& light, Vec3 point, Vec3 normal, float a, float b, float c) {
  Piece piece{light.placed.origin, light.placed.edge_u, light.placed.edge_v, light.is_triangle};
  float whole = -1;  // form factor of `piece` once it is needed
  for (int k = 0; k < kHalvingsMax && !piece.is_far(point, normal); ++k) {
    if (whole < 0) whole = piece.form_factor(point, normal);
    if (!(whole > 0)) break;
    const auto [first, second] = piece.halves();
    const float of_first = std::min(whole, first.form_factor(point, normal));
    const float share = of_first / whole;
    const bool is_first = c < share;
    c = is_first ? c / share : (c - share) / (1.0f - share);
    whole = is_first ? of_first : whole - of_first;
    piece = is_first ? first : second;
  }
  const Contribution contribution{point, normal};
  const float over_light = std::abs(dot(light.placed.normal, point - light.placed.origin));
  return point_of(piece, contribution, contribution.bound(piece, over_light), a, b, c);
}

}  // namespace engine
