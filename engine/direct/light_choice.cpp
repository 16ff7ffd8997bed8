#include "engine/direct/light_choice.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/direct/arrival.h"

namespace engine {
namespace {

/// A light whose share of the patch's light is larger gets rays of its own: drawn, it would get about half as
/// many.
constexpr double kOwnShare = 0.5 / kLightsEachMax;
constexpr std::size_t kOwnMax = kLightsEachMax - kLightsEachMax / 4;  ///< of those at most
constexpr double kDefensive = 0.1;

/// Mean height over a plane of a thing whose middle is `height` over it, where it is above: > 0 as long as
/// anything of it can be.
float mean_height(float height, float radius) {
  if (height >= radius) return height;
  if (height <= -radius) return 0;
  return (height + radius) * (height + radius) / (4 * radius);
}

float facet_weight(const Receiver& receiver, const LightBall& light) {
  const Vec3 apart = light.middle - receiver.middle;
  const float over_patch = mean_height(dot(receiver.placed.normal, apart), light.radius_m);
  const float over_light = mean_height(-dot(light.normal, apart), receiver.radius_m);
  const float near = 0.5f * (receiver.radius_m + light.radius_m);
  const float squared = std::max(dot(apart, apart), near * near);
  constexpr float kPi = std::numbers::pi_v<float>;
  return light.area_m2 * over_patch * over_light / (kPi * squared * (squared + light.area_m2 / kPi));
}

float source_weight(const Receiver& receiver, const LightPose& light) {
  const Vec3 normal = receiver.placed.normal;
  if (light.source->type == api::LightType::directional) return std::max(0.0f, -dot(normal, light.direction));
  const Vec3 apart = light.position - receiver.middle;
  const float height = dot(normal, apart), radius = receiver.radius_m;
  if (height <= 0) return 0;
  const float squared = std::max(dot(apart, apart), 0.25f * radius * radius);
  const float weight = height / (squared * std::sqrt(squared));
  if (light.source->type == api::LightType::point) return weight;
  return weight * largest_spot_share(*light.source, light.direction, -apart, radius);
}

/// 0 where the light cannot shine on the patch.
float weight_of(const Receiver& receiver, const WindowLight& light, const BrightnessTable& brightness) {
  if (light.facet == receiver.facet) return 0;
  float largest = 0;
  for (const LightPose& pose : light.poses) {
    if (!light.is_static && overlap(receiver.slots, pose.slots).empty()) continue;
    largest =
        std::max(largest, pose.source ? source_weight(receiver, pose) : facet_weight(receiver, pose.ball));
  }
  return largest * brightness.of[light.brightness].importance;
}

struct Weighed {
  std::uint32_t light = 0;
  float weight = 0;
};

}  // namespace

LightChoice choose_lights(const Receiver& receiver, std::span<const WindowLight> lights,
                          const BrightnessTable& brightness) {
  LightChoice choice;
  if (lights.size() <= kLightsEachMax) {
    choice.each.resize(lights.size());
    std::iota(choice.each.begin(), choice.each.end(), 0u);
    return choice;
  }
  std::vector<Weighed> weighed;
  double sum = 0;
  for (std::uint32_t l = 0; l < lights.size(); ++l) {
    const float weight = weight_of(receiver, lights[l], brightness);
    if (!(weight > 0)) continue;
    weighed.push_back({l, weight});
    sum += weight;
  }
  if (weighed.size() <= kLightsEachMax) {
    for (const Weighed& w : weighed) choice.each.push_back(w.light);
    return choice;
  }

  const auto by_light = [](const Weighed& a, const Weighed& b) { return a.light < b.light; };
  const auto by_weight = [&](const Weighed& a, const Weighed& b) {
    return a.weight != b.weight ? a.weight > b.weight : by_light(a, b);
  };
  const auto own_end = weighed.begin() + kOwnMax;
  std::partial_sort(weighed.begin(), own_end, weighed.end(), by_weight);
  const auto drawn =
      std::find_if(weighed.begin(), own_end, [&](const Weighed& w) { return w.weight < kOwnShare * sum; });
  for (auto w = weighed.begin(); w != drawn; ++w) choice.each.push_back(w->light);
  std::sort(choice.each.begin(), choice.each.end());
  std::sort(drawn, weighed.end(), by_light);  // neighbours in the scene are often neighbours in number

  double rest = 0;
  for (auto w = drawn; w != weighed.end(); ++w) rest += w->weight;
  const double count = static_cast<double>(weighed.end() - drawn), least = kDefensive * rest / count;
  for (auto w = drawn; w != weighed.end(); ++w)
    choice.drawn.push_back({w->light, static_cast<float>((w->weight + least) / (rest * (1 + kDefensive)))});
  const float budget = kLightsEachMax * std::min(brightness.variety, kVarietyMax);
  choice.shared_lights = budget - static_cast<float>(choice.each.size());
  return choice;
}

}  // namespace engine
