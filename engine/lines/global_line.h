// Lines that cross the whole scene irrespective of its patches.
#pragma once

#include <cstdint>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// An axis-aligned box that contains every surface in every frame.
struct LineBox {
  Vec3 lower, upper;  ///< [m]
};

/// The box of the whole animation, a thousandth of its diagonal larger on every side, so that lines start
/// off the walls and a flat scene has a box too.
LineBox line_box(const Patches& patches, const Animation& animation);

double surface_m2(const LineBox& box);

/// Line number `line` of the uniform density of lines through the box: a point uniform on its surface, a
/// direction inwards with density cos(theta) / pi. Scrambled Sobol points; the same line for every frame.
/// The ray starts on the box; its direction is a unit vector.
///
/// Why on the box: lines that meet a convex body are uniform when they enter it uniformly and with a cosine,
/// and a bounding sphere would waste those that miss the scene.
/// Source: Sbert, "An integral geometry based method for fast form-factor computation", CGF 12(3), 1993.
Ray global_line(const LineBox& box, std::uint32_t line, std::uint64_t seed);

/// Expected number of times `line_count` global lines meet a patch, from either side.
///
///     E[n_i] = 2 N A_i / S                                                   [crossings]
///
/// N  line_count       A_i  patch_area_m2, one side  [m^2]       S  box_surface_m2 > 0  [m^2]
///
/// Why: lines that meet a convex body of surface S have measure pi S / 2, those that meet the patch pi A_i.
/// Occlusion does not matter: a line is followed through all its intersections.
/// Source: Sbert, as above.
double expected_crossings(std::uint64_t line_count, double patch_area_m2, double box_surface_m2);

}  // namespace engine
