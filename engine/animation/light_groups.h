// Lights that are solved apart: what a job names, and what varies together.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/animation/animation.h"

namespace engine {

/// Lights whose light is solved by itself: light is linear in what emits, so the radiosity of a scene is
///
///     B_f = sum_g scale_g(f) B_g,f                                           [W/m^2]
///
/// with B_g,f the radiosity under `emission` of group g alone. A light that only changes its brightness is
/// constant in `emission` and varies in `scale`: no key-frame and no line is spent on its blinking.
struct LightGroup {
  std::string name;        ///< of the job's group it belongs to; several may belong to one. "": no group
  Emission emission;       ///< of the whole scene, zero for what is not of this group
  std::vector<Rgb> scale;  ///< [frame], or one; per channel, >= 0
};

/// Curves of brightness that are factored out at most; where the lights of a scene have more, those beyond
/// stay as they are, with scale 1: each group is a solution of its own and costs as much.
inline constexpr std::size_t kScaledGroupsMax = 3;

/// Splits what the animation emits by `named` (group name -> names of materials and lights; see
/// api::LightingOptions::light_groups) and, within each, by common curves of brightness. In order of name,
/// steady lights first. At least one group, also where nothing emits.
std::vector<LightGroup> light_groups(const Scene& scene, const Animation& animation,
                                     const std::map<std::string, std::vector<std::string>>& named);

/// Mean over all frames of what `group` emits: the emission of the scene at rest.
Rgb mean_exitance(const Emission& emission, std::uint32_t material);

}  // namespace engine
