// The lights of a window of frames, in the slots in which they shine.
#pragma once

#include <span>
#include <vector>

#include "engine/direct/clearance.h"
#include "engine/direct/light_sampling.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// A light where it is in slots [placed.first_slot, placed.last_slot], in the first and last of which it
/// shines.
struct LightPose : PlacedLight {
  Roughness roughness;
};

struct WindowLight {
  std::uint32_t facet = 0, material = 0;
  SlotMask lit;  ///< the slots in which its exitance is not zero
  std::vector<LightPose> poses;
};

/// Those that shine in some slot of the window `frames` (1 .. kWindowMax, increasing); poses in which a light
/// is off are left out.
std::vector<WindowLight> place_window_lights(const Patches& patches, const Animation& animation,
                                             std::span<const FrameIndex> frames);

/// Cuts dark slots off both ends of [first, last]. False where none is lit.
bool narrow_to_lit(const SlotMask& lit, std::uint32_t& first, std::uint32_t& last);

}  // namespace engine
