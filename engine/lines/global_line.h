// Lines that cross the whole scene irrespective of its patches.
#pragma once

#include <cstdint>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"
#include "engine/visibility/line_packet.h"

namespace engine {

/// An axis-aligned box that contains every surface in every frame.
struct LineBox {
  Vec3 lower, upper;  ///< [m]
  /// Lines 16 k .. 16 k + 15 are a bundle: parallel, this far from each other on the box's face. 0: every
  /// line is independent of the others  [m]
  float bundle_m = 0;
};

/// From so many patches on lines come in bundles, which cover few of the patches then.
inline constexpr std::uint32_t kPatchesForBundles = 2048;

/// The box of the whole animation, a thousandth of its diagonal larger on every side, so that lines start
/// off the walls and a flat scene has a box too. Lines of a bundle are two mean patches' edges apart.
LineBox line_box(const Patches& patches, const Animation& animation);

double surface_m2(const LineBox& box);

/// Line number `line` of the uniform density of lines through the box: a point uniform on its surface, a
/// direction inwards with density cos(theta) / pi. Scrambled Sobol points; the same line for every frame.
/// The ray starts on the box; its direction is a unit vector.
///
/// The lines of a bundle share their direction and stand in a lattice of 4 x 4, which is continued on the
/// other side of the face where it ends: so each of them has the density of a single line, and none misses
/// the box. They pass through different patches, so that little is lost,
/// and what one of them meets its neighbours meet: they are traced together.
///
/// Why on the box: lines that meet a convex body are uniform when they enter it uniformly and with a cosine,
/// and a bounding sphere would waste those that miss the scene.
/// Source: Sbert, "An integral geometry based method for fast form-factor computation", CGF 12(3), 1993.
Ray global_line(const LineBox& box, std::uint32_t line, std::uint64_t seed);

/// Lines first .. first + count - 1, those of one packet: `first` is a multiple of 16, `count` at most 16.
void global_lines(const LineBox& box, std::uint32_t first, std::uint32_t count, std::uint64_t seed,
                  LinePacket& packet);

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
