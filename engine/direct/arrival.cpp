#include "engine/direct/arrival.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// False where no point of the facet's plane can see the light's front.
bool faces(const PlacedFacet& at, const PlacedLight& light) {
  const auto polygon = light.polygon();
  if (std::none_of(polygon.begin(), polygon.end(),
                   [&](Vec3 corner) { return dot(at.normal, corner - at.origin) > 0; }))
    return false;
  const Vec3 corners[4] = {at.origin, at.origin + at.edge_u, at.origin + at.edge_v,
                           at.origin + at.edge_u + at.edge_v};
  return std::any_of(std::begin(corners), std::end(corners),
                     [&](Vec3 corner) { return dot(light.placed.normal, corner - light.placed.origin) > 0; });
}

/// Share of a spot's intensity at the cosine `c` from its axis.
float spot_share(const SourceMotion& spot, float c) {
  const double width = spot.inner_cosine - spot.outer_cosine, beyond = c - spot.outer_cosine;
  if (!(width > 0)) return beyond >= 0 ? 1 : 0;
  const double t = std::clamp(beyond / width, 0.0, 1.0);
  return static_cast<float>(t * t * (3 - 2 * t));
}

}  // namespace

float largest_spot_share(const SourceMotion& spot, Vec3 direction, Vec3 apart, float radius_m) {
  const float distance = length(apart);
  if (distance <= radius_m) return 1;
  const float cosine = std::clamp(dot(direction, apart) / distance, -1.0f, 1.0f);
  constexpr float kRounding = 1e-3f;
  const float nearest = std::acos(cosine) - std::asin(radius_m / distance) - kRounding;
  return nearest <= 0 ? 1 : spot_share(spot, std::cos(nearest));
}

Arrivals::Arrivals(const Receiver& receiver, const LightPose& light, float reach_m)
    : receiver_(receiver),
      light_(light),
      reach_m_(reach_m),
      gap_m_(clearance_m(light.roughness, receiver.roughness)),
      off_patch_(clearance_m(receiver.roughness, light.roughness) * receiver.placed.normal),
      off_light_(gap_m_ * light.facet.placed.normal) {}

bool Arrivals::possible() const {
  if (!light_.source) return faces(receiver_.placed, light_.facet);
  const Vec3 normal = receiver_.placed.normal;
  if (light_.source->type == api::LightType::directional) return dot(normal, light_.direction) < 0;
  return dot(normal, light_.position - receiver_.placed.origin) > 0;
}

float Arrivals::source_factor(Vec3 on_patch) const {
  const SourceMotion& source = *light_.source;
  const Vec3 normal = receiver_.placed.normal;
  if (source.type == api::LightType::directional) return std::max(0.0f, -dot(normal, light_.direction));
  const Vec3 apart = light_.position - on_patch;
  const float height = dot(normal, apart), squared = dot(apart, apart);
  if (height <= 0) return 0;
  const float distance = std::sqrt(squared), factor = height / (squared * distance);
  if (source.type == api::LightType::point) return factor;
  return factor * spot_share(source, -dot(light_.direction, apart) / distance);
}

Ray Arrivals::shadow(Vec3 on_patch, const LightDraw& numbers) const {
  const Vec3 start = on_patch + off_patch_;
  if (!light_.source) {
    const Vec3 on_light =
        sample_light(light_.facet, on_patch, receiver_.placed.normal, numbers.a, numbers.b, numbers.piece);
    return {start, on_light + off_light_ - start, 0.0f, 1.0f};
  }
  if (light_.source->type == api::LightType::directional)
    return {start, -reach_m_ * light_.direction, 0.0f, 1.0f};
  const float distance = length(light_.position - on_patch);
  return {start, light_.position - start, 0.0f, std::max(0.5f, 1.0f - gap_m_ / distance)};
}

}  // namespace engine
