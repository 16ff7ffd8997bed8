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
  std::string name;  ///< of the job's group it belongs to; several may belong to one. "": no group
  /// Of the whole scene: materials and sources keep their numbers, and what is not of this group emits zero
  /// (a series of one; such a source rests where it begins).
  Emission emission;
  std::vector<Rgb> scale;  ///< [frame], or one; per channel, 0 .. 1, or 1 throughout
};

/// Does its emission say all?
inline bool is_unscaled(const LightGroup& group) {
  return group.scale.size() == 1 && group.scale[0] == Rgb{1, 1, 1};
}

/// Curves of brightness that are factored out at most; where the lights of a scene have more, those beyond
/// stay as they are, with scale 1: each group is a solution of its own and costs as much.
inline constexpr std::size_t kScaledGroupsMax = 3;

/// Splits what the animation emits by `named` (group name -> names of materials and lights; see
/// api::LightingOptions::light_groups) and, within each, by common curves of brightness:
///
///     exitance_c(m, f) = scale_c(f) * base_c(m),   base_c(m) = max_f exitance_c(m, f)       c = r, g, b
///
/// Lights are steady, or share a group with those whose scale_c is theirs within 1e-6 in every channel in
/// which both emit. Only brightness counts: a light that moves may be steady. The first `curves_max`
/// curves, by the names of their lights, are factored out; lights of further curves are with the steady ones
/// of their group, as animated. So every material and source that ever emits is of exactly one LightGroup,
/// and sum_g scale_g * emission_g is what the animation emits, but for rounding.
///
/// In order of name, steady lights first. A name of `named` whose lights never emit has no group. A light
/// that several name is of the first. At least one group, also where nothing emits.
std::vector<LightGroup> light_groups(const Scene& scene, const Animation& animation,
                                     const std::map<std::string, std::vector<std::string>>& named,
                                     std::size_t curves_max = kScaledGroupsMax);

/// Mean over all frames of what `emission` has the material emit: the emission of the scene at rest.
Rgb mean_exitance(const Emission& emission, std::uint32_t material);

}  // namespace engine
