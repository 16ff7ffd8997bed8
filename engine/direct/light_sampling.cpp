#include "engine/direct/light_sampling.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// Beyond this many diameters the contribution of a light's points differs by less than a quarter.
constexpr float kFarDiameters = 5.0f;
constexpr int kGrid = 4;

/// Uniform by area on the light. Triangles: the square folded over its diagonal.
Vec3 point_on(const PlacedLight& light, float u, float v) {
  if (light.is_triangle && u + v > 1.0f) {
    u = 1.0f - u;
    v = 1.0f - v;
  }
  return light.placed.origin + u * light.placed.edge_u + v * light.placed.edge_v;
}

/// cos cos / r^2 up to a factor common to all points of the light.
float contribution(const PlacedLight& light, Vec3 on_light, Vec3 point, Vec3 normal) {
  const Vec3 to_light = on_light - point;
  const float squared = dot(to_light, to_light);
  const float cosines =
      std::max(0.0f, dot(normal, to_light)) * std::max(0.0f, -dot(light.placed.normal, to_light));
  return squared > 0 ? cosines / (squared * squared) : 0.0f;
}

Vec3 resample(const PlacedLight& light, Vec3 point, Vec3 normal, float a, float b, float c) {
  std::array<Vec3, kGrid * kGrid> candidates;
  std::array<float, kGrid * kGrid> cumulative;
  float total = 0;
  for (int k = 0; k < kGrid * kGrid; ++k) {
    const float u = (static_cast<float>(k % kGrid) + a) / kGrid,
                v = (static_cast<float>(k / kGrid) + b) / kGrid;
    candidates[k] = point_on(light, u, v);
    cumulative[k] = total += contribution(light, candidates[k], point, normal);
  }
  const auto chosen = std::upper_bound(cumulative.begin(), cumulative.end(), c * total);
  return candidates[std::min<std::ptrdiff_t>(chosen - cumulative.begin(), kGrid * kGrid - 1)];
}

}  // namespace

std::vector<Light> find_lights(const Patches& patches, const Animation& animation) {
  std::vector<Light> lights;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const auto& series = animation.exitance_w_m2[patches.facets[f].material];
    if (std::any_of(series.begin(), series.end(), [](Rgb e) { return max_channel(e) > 0; }))
      lights.push_back({f});
  }
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
  light.diameter_m = std::max(length(u + v), length(u - v));
  if (facet.is_triangle) light.diameter_m = std::max({length(u), length(v), length(u - v)});
  return light;
}

Vec3 sample_light(const PlacedLight& light, Vec3 point, Vec3 normal, float a, float b, float c) {
  const Vec3 middle = light.is_triangle
                          ? light.placed.origin + (1.0f / 3.0f) * (light.placed.edge_u + light.placed.edge_v)
                          : light.placed.origin + 0.5f * (light.placed.edge_u + light.placed.edge_v);
  const float far = kFarDiameters * light.diameter_m;
  const Vec3 apart = middle - point;
  if (dot(apart, apart) > far * far && dot(normal, apart) > light.diameter_m) return point_on(light, a, b);
  return resample(light, point, normal, a, b, c);
}

}  // namespace engine
