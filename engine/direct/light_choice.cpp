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

/// Those that can shine on the patch, in order.
std::vector<Weighed> weigh(const Receiver& receiver, std::span<const WindowLight> lights,
                           const BrightnessTable& brightness) {
  std::vector<Weighed> weighed;
  for (std::uint32_t l = 0; l < lights.size(); ++l) {
    const float weight = weight_of(receiver, lights[l], brightness);
    if (weight > 0) weighed.push_back({l, weight});
  }
  return weighed;
}

double total(std::span<const Weighed> weighed) {
  return std::accumulate(weighed.begin(), weighed.end(), 0.0,
                         [](double sum, const Weighed& w) { return sum + w.weight; });
}

bool is_before(const Weighed& a, const Weighed& b) {
  return a.light < b.light;
}

/// Moves those that get their own rays to the front, in order, the rest behind them, in order. Answers how
/// many they are.
std::size_t part_own(std::vector<Weighed>& weighed) {
  const double least = kOwnShare * total(weighed);
  const auto own_end = weighed.begin() + std::min(kOwnMax, weighed.size());
  std::partial_sort(weighed.begin(), own_end, weighed.end(), [](const Weighed& a, const Weighed& b) {
    return a.weight != b.weight ? a.weight > b.weight : is_before(a, b);
  });
  const auto rest =
      std::find_if(weighed.begin(), own_end, [&](const Weighed& w) { return w.weight < least; });
  std::sort(weighed.begin(), rest, is_before);
  std::sort(rest, weighed.end(), is_before);  // neighbours in number are often neighbours in the scene
  return static_cast<std::size_t>(rest - weighed.begin());
}

std::vector<DrawnLight> probabilities(std::span<const Weighed> weighed) {
  const double sum = total(weighed), least = kDefensive * sum / static_cast<double>(weighed.size());
  std::vector<DrawnLight> drawn;
  for (const Weighed& w : weighed)
    drawn.push_back({w.light, static_cast<float>((w.weight + least) / (sum * (1 + kDefensive)))});
  return drawn;
}

}  // namespace

LightChoice choose_lights(const Receiver& receiver, std::span<const WindowLight> lights,
                          const BrightnessTable& brightness) {
  LightChoice choice;
  if (lights.size() <= kLightsEachMax) {
    choice.each.resize(lights.size());
    std::iota(choice.each.begin(), choice.each.end(), 0u);
    return choice;
  }
  std::vector<Weighed> weighed = weigh(receiver, lights, brightness);
  const bool few = weighed.size() <= kLightsEachMax;
  const std::size_t own = few ? weighed.size() : part_own(weighed);
  for (std::size_t k = 0; k < own; ++k) choice.each.push_back(weighed[k].light);
  if (few) return choice;
  choice.drawn = probabilities(std::span(weighed).subspan(own));
  const float budget = kLightsEachMax * std::min(brightness.variety, kVarietyMax);
  choice.shared_lights = budget - static_cast<float>(own);
  return choice;
}

}  // namespace engine
