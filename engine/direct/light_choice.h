// Which of many lights get the samples of a patch.
#pragma once

#include "engine/direct/receiver.h"

namespace engine {

/// Where no more lights than this can shine on a patch, each gets its samples_per_light; where more can,
/// they share as many as these would get.
inline constexpr std::uint32_t kLightsEachMax = 32;

/// Lights that take turns get more samples, since each must be known in its own frames; up to this factor.
inline constexpr float kVarietyMax = 4;

/// A light that is drawn by chance.
struct DrawnLight {
  std::uint32_t light = 0;  ///< into the lights chosen from
  float probability = 0;    ///< > 0
};

/// The lights that can shine on a patch, each of them in one of the two.
struct LightChoice {
  std::vector<std::uint32_t> each;  ///< get samples_per_light of their own, in order
  /// Share `shared_lights` times samples_per_light, in order; the probabilities add up to 1.
  std::vector<DrawnLight> drawn;
  float shared_lights = 0;
};

/// Deals out the samples of a patch: the lights that matter most get their own, the others are drawn with a
/// probability close to their share of the patch's unoccluded light,
///
///     p_l = (w_l + D) / sum_k (w_k + D),    D = mean w / 10
///     w_l = importance A h_p h_l / (pi d^2 (d^2 + A / pi))                   (facets)
///
/// d: from middle to middle; h_p: mean height of the light over the patch's plane, where it is above; h_l: of
/// the patch over the light's. The estimate sum_s E_l F_l V / (n p_l) is right whatever the p_l, as long as
/// no light that shines on some point of the patch in some slot has p_l = 0: h is 0 only where no point is
/// above the plane. D keeps one that w underestimates from an outlier. Nothing of it depends on the frame: a
/// draw serves all frames alike, and lights at rest are chosen for a patch at rest alike in every window.
/// `lights` with several poses: the largest w of those in slots of the receiver's.
/// Source of the scheme: Shirley, Wang & Zimmerman, ACM TOG 15(1), 1996.
LightChoice choose_lights(const Receiver& receiver, std::span<const WindowLight> lights,
                          const BrightnessTable& brightness);

}  // namespace engine
